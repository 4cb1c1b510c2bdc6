#include "scene/animation_targets.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "scene/material_table.h"

namespace candela {
namespace {

constexpr double tiny = 1e-6;  // stands in for "greater than zero"

}  // namespace

std::string light_place(const Scene& scene, size_t light) {
  return fmt::format("/extensions/KHR_lights_punctual/lights/{} '{}'", light,
                     light < scene.lights.size() ? scene.lights[light].name : "");
}

PropertyRange range_of(TargetPath path) {
  using enum TargetPath;
  constexpr double right_angle = std::numbers::pi / 2;
  if (const MaterialProperty* p = material_property(path)) return {p->name(), p->lowest, p->highest};
  switch (path) {
    case node_translation:
      return {"translation"};
    case node_rotation:
      return {"rotation"};
    case node_scale:
      return {"scale"};
    case node_weights:
      return {"weights"};
    case node_visible:
      return {"visible"};
    case texture_offset:
      return {"KHR_texture_transform/offset"};
    case texture_rotation:
      return {"KHR_texture_transform/rotation"};
    case texture_scale:
      return {"KHR_texture_transform/scale"};
    case light_color:
      return {"color", 0, 1};
    case light_intensity:
      return {"intensity", 0};
    case light_range:
      return {"range", tiny};
    case light_inner_cone:
      return {"innerConeAngle", 0, right_angle};
    case light_outer_cone:
      return {"outerConeAngle", tiny, right_angle};
    case camera_yfov:
      return {"yfov", tiny, std::numbers::pi - tiny};
    case camera_aspect:
      return {"aspectRatio", tiny};
    case camera_near:
      return {"znear", 0};
    case camera_far:
      return {"zfar", tiny};
    case camera_xmag:
      return {"xmag"};
    case camera_ymag:
      return {"ymag"};
    case metaballs_threshold:
      return {"threshold", 0, 1e6};
    case metaballs_radius:
      return {"radius", tiny, 1e15};
    case metaballs_strength:
      return {"strength", -1e6, 1e6};
    default:
      break;
  }
  return {"value"};
}

namespace {

std::string place_of(const AnimationTarget& target, const AnimationChannel& channel) {
  const char* array = channel.path <= TargetPath::node_visible    ? "nodes"
                      : channel.path <= TargetPath::texture_scale ? "materials"
                                                                  : "cameras";
  if (channel.path >= TargetPath::metaballs_threshold) {
    const int node = target.scene.metaballs[size_t(channel.object)].node;
    const std::string body = fmt::format("/nodes/{}/extensions/CANDELA_metaballs", node);
    return channel.element < 0 ? body : fmt::format("{}/balls/{}", body, channel.element);
  }
  return drives_light(channel.path) ? light_place(target.scene, size_t(channel.object))
                                    : fmt::format("/{}/{}", array, channel.object);
}

void warn(AnimationTarget& target, const AnimationChannel& channel, double value, const std::string& instead) {
  target.pose.warnings.push_back(
      fmt::format("{} {}: animation '{}' gives {} at {} s; {}", place_of(target, channel), range_of(channel.path).name,
                  target.animation ? target.animation->name : "", value, target.time_s, instead));
}

// One number into its place: checked as float, for a double may be finite and its float not.
template <class T>
void assign(AnimationTarget& target, const AnimationChannel& channel, T& destination, double value) {
  const PropertyRange property = range_of(channel.path);
  if (!std::isfinite(float(value))) {
    if (channel.path == TargetPath::light_intensity) destination = T(0);
    return warn(target, channel, value, fmt::format("{} is taken", destination));
  }
  // An index of refraction of 0 has its own meaning; between 0 and 1 there is nothing.
  const double lowest = channel.path == TargetPath::material_ior && value != 0 ? 1 : property.lowest;
  const double inside = std::min(std::max(value, lowest), property.highest);
  if (inside != value) warn(target, channel, value, fmt::format("{} is taken", inside));
  destination = T(inside);
}

// A vector property, whole or one component of it.
template <class V>
void assign_vector(AnimationTarget& target, const AnimationChannel& channel, V& destination,
                   std::span<const double> values, int component) {
  if (component >= 0) {
    if (component < int(V::length()) && !values.empty()) assign(target, channel, destination[component], values[0]);
    return;
  }
  for (size_t c = 0; c < values.size() && c < size_t(V::length()); ++c)
    assign(target, channel, destination[int(c)], values[c]);
}

void apply_weights(AnimationTarget& target, const AnimationChannel& channel, std::span<const double> values) {
  std::vector<float>& weights = target.pose.node_weights[size_t(channel.object)];
  if (channel.element >= 0) {
    if (size_t(channel.element) < weights.size()) assign(target, channel, weights[size_t(channel.element)], values[0]);
    return;
  }
  for (size_t i = 0; i < values.size() && i < weights.size(); ++i) assign(target, channel, weights[i], values[i]);
}

void apply_to_node(AnimationTarget& target, const AnimationChannel& channel, std::span<const double> values) {
  NodeState& node = target.nodes[size_t(channel.object)];
  switch (channel.path) {
    case TargetPath::node_translation:
      return assign_vector(target, channel, node.translation, values, channel.element);
    case TargetPath::node_scale:
      return assign_vector(target, channel, node.scale, values, channel.element);
    case TargetPath::node_rotation:
      if (values.size() == 4) node.rotation = glm::dquat(values[3], values[0], values[1], values[2]);
      return;
    case TargetPath::node_visible:
      node.visible = values[0] != 0;
      return;
    default:
      return apply_weights(target, channel, values);
  }
}

void apply_to_material(AnimationTarget& target, const AnimationChannel& channel, std::span<const double> values) {
  using enum TargetPath;
  Material& m = target.pose.materials[size_t(channel.object)];
  if (const MaterialProperty* p = material_property(channel.path)) {
    float* values_at = p->at(m);
    if (channel.element >= 0) return assign(target, channel, values_at[channel.element], values[0]);
    for (size_t c = 0; c < values.size() && c < size_t(p->components); ++c)
      assign(target, channel, values_at[c], values[c]);
    return;
  }
  TextureSlot& slot = texture_slot(m, TextureSlotName(channel.element));
  switch (channel.path) {
    case texture_offset:
      return assign_vector(target, channel, slot.offset, values, -1);
    case texture_scale:
      return assign_vector(target, channel, slot.scale, values, -1);
    case texture_rotation:
      return assign(target, channel, slot.rotation_rad, values[0]);
    default:
      return;
  }
}

void apply_to_light(AnimationTarget& target, const AnimationChannel& channel, std::span<const double> values) {
  using enum TargetPath;
  Light& light = target.pose.lights[size_t(channel.object)];
  switch (channel.path) {
    case light_color:
      return assign_vector(target, channel, light.color, values, channel.element);
    case light_intensity:
      return assign(target, channel, light.intensity, values[0]);
    case light_range:
      return assign(target, channel, light.range_m, values[0]);
    case light_inner_cone:
      return assign(target, channel, light.inner_cone_rad, values[0]);
    case light_outer_cone:
      return assign(target, channel, light.outer_cone_rad, values[0]);
    default:
      return;
  }
}

void apply_to_camera(AnimationTarget& target, const AnimationChannel& channel, std::span<const double> values) {
  using enum TargetPath;
  Camera& camera = target.pose.cameras[size_t(channel.object)];
  switch (channel.path) {
    case camera_yfov:
      return assign(target, channel, camera.yfov_rad, values[0]);
    case camera_aspect:
      return assign(target, channel, camera.aspect, values[0]);
    case camera_near:
      return assign(target, channel, camera.near_m, values[0]);
    case camera_far:
      return assign(target, channel, camera.far_m, values[0]);
    case camera_xmag:
      return assign(target, channel, camera.xmag, values[0]);
    case camera_ymag:
      return assign(target, channel, camera.ymag, values[0]);
    default:
      return;
  }
}

void apply_to_metaballs(AnimationTarget& target, const AnimationChannel& channel, std::span<const double> values) {
  Metaballs& body = target.pose.metaballs[size_t(channel.object)];
  if (channel.path == TargetPath::metaballs_threshold) return assign(target, channel, body.threshold, values[0]);
  if (channel.element < 0 || size_t(channel.element) >= body.balls.size()) return;
  Metaball& ball = body.balls[size_t(channel.element)];
  assign(target, channel, channel.path == TargetPath::metaballs_radius ? ball.radius_m : ball.strength, values[0]);
}

}  // namespace

void apply_channel(AnimationTarget& target, const AnimationChannel& channel, std::span<const double> values) {
  if (channel.object < 0 || values.empty()) return;
  const size_t object = size_t(channel.object);
  if (channel.path <= TargetPath::node_visible) {
    if (object >= target.nodes.size()) return;
    const bool moves = channel.path <= TargetPath::node_scale;
    if (moves && target.scene.nodes[object].has_matrix)
      return warn(target, channel, values[0], "a node with a matrix may not be animated, so the matrix stands");
    return apply_to_node(target, channel, values);
  }
  if (channel.path <= TargetPath::texture_scale)
    return object < target.pose.materials.size() ? apply_to_material(target, channel, values) : void();
  if (channel.path <= TargetPath::light_outer_cone)
    return object < target.pose.lights.size() ? apply_to_light(target, channel, values) : void();
  if (channel.path >= TargetPath::metaballs_threshold)
    return object < target.pose.metaballs.size() ? apply_to_metaballs(target, channel, values) : void();
  return object < target.pose.cameras.size() ? apply_to_camera(target, channel, values) : void();
}

}  // namespace candela
