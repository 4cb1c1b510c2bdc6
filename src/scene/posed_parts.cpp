#include "scene/posed_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

#include "math/transforms.h"
#include "scene/animation_targets.h"
#include "scene/scene_path.h"

namespace candela {
namespace {

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

glm::dmat4 local_of(const Node& node, const NodeState& state) {
  // Cameras and lights have no size: the scale of a node that carries nothing else does not count.
  const bool scales =
      node.mesh >= 0 || node.light_instances || !node.children.empty() || (node.camera < 0 && node.light < 0);
  return node.has_matrix ? node.matrix
                         : compose_trs(state.translation, unit(state.rotation), scales ? state.scale : glm::dvec3(1));
}

void place_nodes_once(const Scene& scene, const PosedParts& parts, const std::vector<PathPlace>& on_paths,
                      const PoseState& states, Pose& pose) {
  const std::vector<glm::dmat4> before = std::move(pose.world_from_node);
  pose.world_from_node.assign(scene.nodes.size(), glm::dmat4(1.0));
  pose.node_visible.assign(scene.nodes.size(), false);
  for (int n : scene.order) {
    const Node& node = scene.nodes[size_t(n)];
    const NodeState& state = states.nodes[size_t(n)];
    const glm::dmat4 local = local_of(node, state);
    const bool has_parent = parts.below_parent[size_t(n)] != 0;
    const glm::dmat4 parent = has_parent ? pose.world_from_node[size_t(node.parent)] : glm::dmat4(1.0);
    const ScenePath* const path = scene.paths ? scene.paths->of(size_t(n)) : nullptr;
    glm::dmat4& world = pose.world_from_node[size_t(n)];
    if (path) {
      const PathPlace& place = on_paths[size_t(path - scene.paths->paths.data())];
      world = on_path(*path, place, parent, local, before);
    } else {
      world = has_parent ? parent * local : local;
    }
    pose.node_visible[size_t(n)] = state.visible && (!has_parent || pose.node_visible[size_t(node.parent)]);
  }
}

// Nodes that look at others need where these are: once more for each that may hang on another.
void place_nodes(const Scene& scene, const PosedParts& parts, const PoseState& state, Pose& pose) {
  std::vector<PathPlace> on_paths;
  if (scene.paths)
    for (const ScenePath& path : scene.paths->paths) on_paths.push_back(path.at(pose.time_s));
  const size_t times = scene.paths ? 1 + scene.paths->look_at_nodes : 1;
  pose.world_from_node.clear();
  for (size_t i = 0; i < times; ++i) place_nodes_once(scene, parts, on_paths, state, pose);
}

// Those whose own state changed, and what hangs on them.
void place_changed(const Scene& scene, const PosedParts& parts, PoseState& state, Pose& pose) {
  state.placed.assign(scene.nodes.size(), 0);
  for (const int index : scene.order) {
    const size_t n = size_t(index);
    const Node& node = scene.nodes[n];
    const bool has_parent = parts.below_parent[n] != 0;
    const int part = parts.part_of_node[n];
    if (!(part >= 0 && state.changed[size_t(part)]) && !(has_parent && state.placed[size_t(node.parent)])) continue;
    state.placed[n] = 1;
    const glm::dmat4 local = local_of(node, state.nodes[n]);
    pose.world_from_node[n] = has_parent ? pose.world_from_node[size_t(node.parent)] * local : local;
    pose.node_visible[n] = state.nodes[n].visible && (!has_parent || pose.node_visible[size_t(node.parent)]);
  }
}

// The last animation that drives a light's cone; empty: none does.
std::string cone_driver(const PosedParts& parts, size_t light) {
  std::string name;
  for (const auto& [animation, channel, part] : parts.channels)
    if ((channel->path == TargetPath::light_inner_cone || channel->path == TargetPath::light_outer_cone) &&
        size_t(channel->object) == light)
      name = animation->name;
  return name;
}

// Two animated cone angles may cross, though each is in its range.
void order_cones(const Scene& scene, const PosedParts& parts, Pose& pose) {
  for (size_t i = 0; i < pose.lights.size(); ++i) {
    Light& light = pose.lights[i];
    if (light.type != LightType::spot || light.inner_cone_rad <= light.outer_cone_rad) continue;
    pose.warnings.push_back(fmt::format(
        "{} innerConeAngle: animation '{}' gives {} at {} s, which is greater than outerConeAngle {}; that "
        "is taken for both",
        light_place(scene, i), cone_driver(parts, i), light.inner_cone_rad, pose.time_s, light.outer_cone_rad));
    light.inner_cone_rad = light.outer_cone_rad;
  }
}

NodeState node_state(const Node& node) { return {node.translation, node.scale, node.rotation, node.visible}; }

PosedParts::Kind kind_of(TargetPath path) {
  using enum PosedParts::Kind;
  if (path <= TargetPath::node_visible) return node;
  if (path <= TargetPath::texture_scale) return material;
  if (path <= TargetPath::light_outer_cone) return light;
  return path >= TargetPath::metaballs_threshold ? metaballs : camera;
}

size_t objects_of(const Scene& scene, PosedParts::Kind kind) {
  switch (kind) {
    case PosedParts::Kind::node:
      return scene.nodes.size();
    case PosedParts::Kind::material:
      return scene.materials.size();
    case PosedParts::Kind::light:
      return scene.lights.size();
    case PosedParts::Kind::camera:
      return scene.cameras.size();
    case PosedParts::Kind::metaballs:
      break;
  }
  return scene.metaballs.size();
}

constexpr size_t moving_key = ~size_t(0), unknown_key = moving_key - 1;

// The key whose value the channel holds at a time, if it is the same at every time about there (sample_channel()).
size_t held_key(const AnimationChannel& channel, double time_s) {
  const auto after = std::upper_bound(channel.times_s.begin(), channel.times_s.end(), time_s,
                                      [](double time, float key) { return time < double(key); });
  const size_t next = size_t(after - channel.times_s.begin());
  if (next == 0) return 0;
  return next == channel.times_s.size() || channel.interpolation == Interpolation::step ? next - 1 : moving_key;
}

void set_as_in_file(const Scene& scene, const PosedParts::Part& part, PoseState& state, Pose& pose) {
  const size_t i = part.object;
  switch (part.kind) {
    case PosedParts::Kind::node:
      state.nodes[i] = node_state(scene.nodes[i]);
      pose.node_weights[i] = part.weights;
      return;
    case PosedParts::Kind::material:
      pose.materials[i] = scene.materials[i];
      return;
    case PosedParts::Kind::light:
      pose.lights[i] = scene.lights[i];
      return;
    case PosedParts::Kind::camera:
      pose.cameras[i] = scene.cameras[i];
      return;
    case PosedParts::Kind::metaballs:
      pose.metaballs[i] = scene.metaballs[i];
      return;
  }
}

}  // namespace

PosedParts posed_parts(const Scene& scene, const AnimationChoice& choice) {
  static std::atomic<uint64_t> made = 0;
  PosedParts out;
  out.id = ++made;
  out.choice = choice;
  out.part_of_node.assign(scene.nodes.size(), -1);
  out.below_parent.assign(scene.nodes.size(), 0);
  std::vector<bool> above(scene.nodes.size(), false);
  for (const int n : scene.order) {
    const int parent = scene.nodes[size_t(n)].parent;
    out.below_parent[size_t(n)] = parent >= 0 && above[size_t(parent)];
    above[size_t(n)] = true;
  }
  std::vector<int> in_file_order = choice.animations;
  std::sort(in_file_order.begin(), in_file_order.end());
  std::map<std::pair<PosedParts::Kind, uint32_t>, uint32_t> known;
  for (const int a : in_file_order)
    for (const AnimationChannel& channel : scene.animations[size_t(a)].channels) {
      const PosedParts::Kind kind = kind_of(channel.path);
      if (channel.object < 0 || size_t(channel.object) >= objects_of(scene, kind) || channel.components <= 0) continue;
      const uint32_t object = uint32_t(channel.object);
      const auto [found, is_new] = known.try_emplace({kind, object}, uint32_t(out.parts.size()));
      if (is_new) {
        out.parts.push_back({kind, object, {}});
        if (kind == PosedParts::Kind::node) {
          out.part_of_node[object] = int(found->second);
          out.parts.back().weights = initial_weights(scene, scene.nodes[object]);
        }
      }
      out.channels.push_back({&scene.animations[size_t(a)], &channel, found->second});
    }
  return out;
}

void evaluate_pose(const Scene& scene, const PosedParts& parts, double time_s, PoseState& state, Pose& pose) {
  const bool again = state.parts == parts.id;
  pose.time_s = time_s;
  pose.warnings.clear();
  if (!again) {
    pose.materials = scene.materials, pose.lights = scene.lights, pose.cameras = scene.cameras;
    pose.metaballs = scene.metaballs;
    state.nodes.clear(), pose.node_weights.clear();
    state.nodes.reserve(scene.nodes.size()), pose.node_weights.reserve(scene.nodes.size());
    for (const Node& node : scene.nodes) {
      state.nodes.push_back(node_state(node));
      pose.node_weights.push_back(initial_weights(scene, node));
    }
    state.held.assign(parts.channels.size(), unknown_key);
  }
  state.changed.assign(parts.parts.size(), again ? 0 : 1);
  for (size_t i = 0; i < parts.channels.size(); ++i) {
    const size_t held = held_key(*parts.channels[i].channel, time_s);
    if (held == moving_key || held != state.held[i]) state.changed[parts.channels[i].part] = 1;
    state.held[i] = held;
  }
  for (size_t p = 0; again && p < parts.parts.size(); ++p)
    if (state.changed[p]) set_as_in_file(scene, parts.parts[p], state, pose);
  AnimationTarget target{scene, pose, state.nodes, nullptr, time_s};
  for (const auto& [animation, channel, part] : parts.channels) {
    if (!state.changed[part]) continue;
    state.values.assign(size_t(channel->components), 0.0);
    sample_channel(*channel, time_s, state.values);
    target.animation = animation;
    apply_channel(target, *channel, state.values);
  }
  order_cones(scene, parts, pose);
  if (again && !scene.paths)
    place_changed(scene, parts, state, pose);
  else
    place_nodes(scene, parts, state, pose);
  // A warning is said for every frame, and a probe is placed by whoever asks for the pose.
  state.parts = pose.warnings.empty() && scene.probe_node < 0 ? parts.id : 0;
}

}  // namespace candela
