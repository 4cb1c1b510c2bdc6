#include "scene/draw_list.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace candela {

bool is_unlit(const MeshSection& section, const Material* material) {
  return (material && material->unlit) || section.normal.empty();
}

bool refracts(const MeshSection& section, const Material& material) {
  return section.topology == Topology::triangles && material.alpha_mode != AlphaMode::blend &&
         !is_unlit(section, &material) && material.has(Lobe::transmission);
}

namespace {

constexpr uint32_t draw_ranks = 2 * 2 * 2 * 3 * 2 * 2 + 1;

// How an item is drawn; items of one section at many places share it.
DrawRun state_of(const Scene& scene, const Pose& pose, const DrawItem& item, bool refraction) {
  const MeshSection& section = scene.meshes[item.mesh].sections[item.section];
  const Material* material = item.material >= 0 ? &pose.materials[size_t(item.material)] : nullptr;
  DrawRun s;
  s.topology = section.topology;
  s.alpha = material ? material->alpha_mode : AlphaMode::opaque;
  s.unlit = is_unlit(section, material);
  s.cull_back = section.topology == Topology::triangles && !(material && material->double_sided);
  s.mirrored = item.mirrored;
  s.refracts = refraction && material && refracts(section, *material);
  return s;
}

// In the order of drawing; blended ones are the last.
uint32_t rank_of(const DrawRun& s) {
  if (s.alpha == AlphaMode::blend) return draw_ranks - 1;
  uint32_t rank = s.refracts;
  rank = rank * 2 + uint32_t(s.alpha == AlphaMode::mask);
  rank = rank * 2 + uint32_t(s.unlit);
  rank = rank * 3 + uint32_t(s.topology);
  rank = rank * 2 + uint32_t(!s.cull_back);
  return rank * 2 + uint32_t(s.mirrored);
}

}  // namespace

DrawList make_draw_list(const Scene& scene, const Pose& pose, const FrameData& frame, bool refraction) {
  const std::vector<DrawItem>& items = frame.items;
  std::vector<uint8_t> ranks(items.size());
  std::array<uint32_t, draw_ranks + 1> first{};
  for (size_t i = 0; i < items.size(); ++i) {
    const bool same = i > 0 && items[i].mesh == items[i - 1].mesh && items[i].section == items[i - 1].section &&
                      items[i].material == items[i - 1].material && items[i].mirrored == items[i - 1].mirrored;
    ranks[i] = same ? ranks[i - 1] : uint8_t(rank_of(state_of(scene, pose, items[i], refraction)));
    ++first[ranks[i] + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  const uint32_t blended = first[draw_ranks - 1];
  DrawList list;
  list.order.resize(items.size());
  for (size_t i = 0; i < items.size(); ++i) list.order[first[ranks[i]]++] = uint32_t(i);
  // Blended items compare by depth alone, farthest first; the stable sort keeps equal depths in item order.
  std::stable_sort(list.order.begin() + blended, list.order.end(),
                   [&](uint32_t a, uint32_t b) { return items[a].view_depth_m > items[b].view_depth_m; });
  for (uint32_t at = 0; at < list.order.size(); ++at) {
    const uint32_t i = list.order[at];
    if (at > 0 && at < blended && ranks[i] == ranks[list.order[at - 1]]) {
      ++list.runs.back().count;
      continue;
    }
    const DrawRun state = state_of(scene, pose, items[i], refraction);
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
