#include "scene/pose.h"

#include <algorithm>
#include <charconv>
#include <numeric>

#include "math/transforms.h"
#include "scene/animation_targets.h"

#include "base/names.h"

namespace candela {
namespace {

std::string animation_names(const Scene& scene) {
  if (scene.animations.empty()) return "the file has no animations";
  std::string names = "there are";
  for (size_t i = 0; i < scene.animations.size(); ++i)
    names += fmt::format("{} {} {}", i ? "," : "", i, quoted_name(scene.animations[i].name));
  return names;
}

// A quaternion of the file need not have unit length, and double asks for more digits than its floats hold.
glm::dquat unit(glm::dquat q) {
  const double length = glm::length(q);
  return length > 1e-12 && std::isfinite(length) ? q / length : glm::dquat(1, 0, 0, 0);
}

size_t morph_target_count(const Mesh& mesh) {
  size_t count = 0;
  for (const MeshSection& section : mesh.sections) count = std::max(count, section.morph.size());
  return count;
}

// The node's own weights, else the mesh's, else 0 for each target.
std::vector<float> initial_weights(const Scene& scene, const Node& node) {
  if (node.mesh < 0) return {};
  const Mesh& mesh = scene.meshes[size_t(node.mesh)];
  std::vector<float> weights = node.weights.empty() ? mesh.default_weights : node.weights;
  weights.resize(morph_target_count(mesh), 0.0f);
  return weights;
}

void place_nodes(const Scene& scene, const std::vector<NodeState>& nodes, Pose& pose) {
  pose.world_from_node.assign(scene.nodes.size(), glm::dmat4(1.0));
  pose.node_visible.assign(scene.nodes.size(), false);
  std::vector<bool> placed(scene.nodes.size(), false);
  for (int n : scene.order) {
    const Node& node = scene.nodes[size_t(n)];
    const NodeState& state = nodes[size_t(n)];
    const glm::dmat4 local =
        node.has_matrix ? node.matrix : compose_trs(state.translation, unit(state.rotation), state.scale);
    const bool has_parent = node.parent >= 0 && placed[size_t(node.parent)];
    placed[size_t(n)] = true;
    pose.world_from_node[size_t(n)] = has_parent ? pose.world_from_node[size_t(node.parent)] * local : local;
    pose.node_visible[size_t(n)] = state.visible && (!has_parent || pose.node_visible[size_t(node.parent)]);
  }
}

// Two animated cone angles may cross, though each is in its range. `drivers` names the last animation that drove one.
void order_cones(const Scene& scene, const std::vector<const Animation*>& drivers, Pose& pose) {
  for (size_t i = 0; i < pose.lights.size(); ++i) {
    Light& light = pose.lights[i];
    if (light.type != LightType::spot || light.inner_cone_rad <= light.outer_cone_rad) continue;
    pose.warnings.push_back(
        fmt::format("{} innerConeAngle: animation '{}' gives {} at {} s, which is greater than outerConeAngle {}; that "
                    "is taken for both",
                    light_place(scene, i), i < drivers.size() && drivers[i] ? drivers[i]->name : "",
                    light.inner_cone_rad, pose.time_s, light.outer_cone_rad));
    light.inner_cone_rad = light.outer_cone_rad;
  }
}

}  // namespace

Expected<AnimationChoice> choose_animations(const Scene& scene, const std::string& which) {
  AnimationChoice choice;
  if (which == "none") return choice;
  if (which == "all") {
    choice.animations.resize(scene.animations.size());
    std::iota(choice.animations.begin(), choice.animations.end(), 0);
    return choice;
  }
  for (size_t i = 0; i < scene.animations.size(); ++i)
    if (scene.animations[i].name == which) return AnimationChoice{{int(i)}};
  int index = -1;
  const auto [end, error] = std::from_chars(which.data(), which.data() + which.size(), index);
  const bool number = error == std::errc() && end == which.data() + which.size();
  if (number && index >= 0 && size_t(index) < scene.animations.size()) return AnimationChoice{{index}};
  return fail(ErrorKind::usage, scene.path, "no animation '{}': {}; or give all or none", which,
              animation_names(scene));
}

Pose evaluate_pose(const Scene& scene, const AnimationChoice& animations, double time_s) {
  Pose pose;
  pose.time_s = time_s;
  pose.materials = scene.materials;
  pose.lights = scene.lights;
  pose.cameras = scene.cameras;
  std::vector<NodeState> nodes;
  nodes.reserve(scene.nodes.size());
  pose.node_weights.reserve(scene.nodes.size());
  for (const Node& node : scene.nodes) {
    nodes.push_back({node.translation, node.scale, node.rotation, node.visible});
    pose.node_weights.push_back(initial_weights(scene, node));
  }

  std::vector<int> in_file_order = animations.animations;
  std::sort(in_file_order.begin(), in_file_order.end());
  std::vector<double> values;
  std::vector<const Animation*> cone_drivers;  // per light
  for (int a : in_file_order) {
    const Animation& animation = scene.animations[size_t(a)];
    AnimationTarget target{scene, pose, nodes, &animation, time_s};
    for (const AnimationChannel& channel : animation.channels) {
      values.assign(size_t(channel.components), 0.0);
      sample_channel(channel, time_s, values);
      apply_channel(target, channel, values);
      const bool is_cone = channel.path == TargetPath::light_inner_cone || channel.path == TargetPath::light_outer_cone;
      if (!is_cone || channel.object < 0) continue;
      cone_drivers.resize(scene.lights.size());
      if (size_t(channel.object) < cone_drivers.size()) cone_drivers[size_t(channel.object)] = &animation;
    }
  }
  order_cones(scene, cone_drivers, pose);
  place_nodes(scene, nodes, pose);
  return pose;
}

}  // namespace candela
