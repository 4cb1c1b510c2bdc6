#include "scene/neutral_light.h"

namespace candela {

bool has_light(const Scene& scene) {
  return std::any_of(scene.order.begin(), scene.order.end(), [&](int n) {
    const Node& node = scene.nodes[size_t(n)];
    return node.light >= 0 || node.light_instances;
  });
}

void add_neutral_light(const View& view, FrameData& data) {
  const glm::dmat3 relative_from_view = glm::transpose(glm::dmat3(view.view_from_relative));
  LightItem key{};
  key.type = LightType::directional;
  key.direction = glm::vec3(-glm::normalize(relative_from_view * glm::dvec3(-0.45, 0.65, 0.6)));
  key.intensity = glm::vec3(1.4f);  // lux: with the ambient light a white surface comes out just below 1
  key.range_m = std::numeric_limits<float>::infinity();
  data.lights.push_back(key);
}

}  // namespace candela
