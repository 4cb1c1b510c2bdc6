#include "scene/draw_list.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace candela {

bool is_unlit(const MeshSection& section, const Material* material) {
  return (material && material->unlit) || section.normal.empty();
}

bool refracts(const MeshSection& section, const Material& material) {
  return section.topology == Topology::triangles && material.alpha_mode != AlphaMode::blend &&
         !is_unlit(section, &material) && material.has(Lobe::transmission);
}

DrawList make_draw_list(const Scene& scene, const Pose& pose, const FrameData& frame, bool refraction) {
  std::vector<DrawRun> states(frame.items.size());
  for (size_t i = 0; i < frame.items.size(); ++i) {
    const DrawItem& item = frame.items[i];
    const MeshSection& section = scene.meshes[item.mesh].sections[item.section];
    const Material* material = item.material >= 0 ? &pose.materials[size_t(item.material)] : nullptr;
    DrawRun& s = states[i];
    s.topology = section.topology;
    s.alpha = material ? material->alpha_mode : AlphaMode::opaque;
    s.unlit = is_unlit(section, material);
    s.cull_back = section.topology == Topology::triangles && !(material && material->double_sided);
    s.mirrored = item.mirrored;
    s.refracts = refraction && material && refracts(section, *material);
  }
  DrawList list;
  list.order.resize(frame.items.size());
  std::iota(list.order.begin(), list.order.end(), 0u);
  const auto key = [&](uint32_t i) {
    const DrawRun& s = states[i];
    const bool blend = s.alpha == AlphaMode::blend;
    // Blended items compare by depth alone, farthest first; the stable sort keeps equal depths in item order.
    if (blend) return std::tuple(2, -frame.items[i].view_depth_m, 0, 0, 0, 0, 0);
    return std::tuple(int(s.refracts), 0.0, int(s.alpha), int(s.unlit), int(s.topology), int(!s.cull_back),
                      int(s.mirrored));
  };
  std::stable_sort(list.order.begin(), list.order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
  for (uint32_t at = 0; at < list.order.size(); ++at) {
    const DrawRun& state = states[list.order[at]];
    if (list.runs.empty() || !list.runs.back().same_state(state)) {
      list.runs.push_back(state);
      list.runs.back().first = at;
      list.runs.back().count = 0;
    }
    ++list.runs.back().count;
  }
  return list;
}

}  // namespace candela
