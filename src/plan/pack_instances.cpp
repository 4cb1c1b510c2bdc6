#include "plan/frame_upload.h"
#include "plan/packed_values.h"

// pack_light_instances() and pack_mesh_instances() of frame_upload.h.
namespace candela {

std::vector<shared::LightInstance> pack_light_instances(const Scene& scene, const LightLayout& layout) {
  std::vector<shared::LightInstance> out;
  out.reserve(layout.instance_count);
  for (const LightSet& set : layout.sets) {
    const LightInstances& from = *scene.nodes[set.node].light_instances;
    for (size_t i = 0; i < from.count(); ++i) {
      shared::LightInstance to{};
      to.translation = from.translation[i];
      if (!from.direction.empty()) to.direction = from.direction[i];
      to.color = from.color.empty() ? glm::vec3(1) : from.color[i];
      to.intensity = from.intensity.empty() ? 1.0f : from.intensity[i];
      if (!from.range_m.empty()) to.inverse_range = inverse_range(from.range_m[i]);
      const LightModulation modulation = from.modulation.empty() ? LightModulation{} : from.modulation[i];
      to.depth = modulation.depth, to.period = modulation.period_s, to.phase = modulation.phase;
      out.push_back(to);
    }
  }
  return out;
}

std::vector<shared::WideTransform> pack_mesh_instances(const InstanceLayout& layout) {
  std::vector<shared::WideTransform> out;
  out.reserve(layout.instance_count);
  for (const InstanceSet& set : layout.sets)
    for (const glm::dmat4& m : set.node_from_instance) out.push_back(wide(m));
  return out;
}

}  // namespace candela
