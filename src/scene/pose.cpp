#include "scene/pose.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "math/transforms.h"
#include "scene/animation_targets.h"
#include "scene/scene_path.h"

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

void place_nodes_once(const Scene& scene, const std::vector<NodeState>& nodes, const std::vector<PathPlace>& on_paths,
                      Pose& pose) {
  const std::vector<glm::dmat4> before = std::move(pose.world_from_node);
  pose.world_from_node.assign(scene.nodes.size(), glm::dmat4(1.0));
  pose.node_visible.assign(scene.nodes.size(), false);
  std::vector<bool> placed(scene.nodes.size(), false);
  for (int n : scene.order) {
    const Node& node = scene.nodes[size_t(n)];
    const NodeState& state = nodes[size_t(n)];
    // Cameras and lights have no size: the scale of a node that carries nothing else does not count.
    const bool scales =
        node.mesh >= 0 || node.light_instances || !node.children.empty() || (node.camera < 0 && node.light < 0);
    glm::dmat4 local = node.has_matrix
                           ? node.matrix
                           : compose_trs(state.translation, unit(state.rotation), scales ? state.scale : glm::dvec3(1));
    const bool has_parent = node.parent >= 0 && placed[size_t(node.parent)];
    placed[size_t(n)] = true;
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
void place_nodes(const Scene& scene, const std::vector<NodeState>& nodes, Pose& pose) {
  std::vector<PathPlace> on_paths;
  if (scene.paths)
    for (const ScenePath& path : scene.paths->paths) on_paths.push_back(path.at(pose.time_s));
  const size_t times = scene.paths ? 1 + scene.paths->look_at_nodes : 1;
  for (size_t i = 0; i < times; ++i) place_nodes_once(scene, nodes, on_paths, pose);
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

namespace {

// Which properties animations drive, told apart so far as values can meet: a whole property meets its elements.
class DrivenTargets {
 public:
  // The animation that drives this already; -1: none.
  int driver(const AnimationChannel& channel) const {
    const auto found = drivers_.find(key(channel));
    if (found == drivers_.end()) return -1;
    for (const auto& [element, animation] : found->second)
      if (element == channel.element || element < 0 || (channel.element < 0 && !names_texture(channel)))
        return animation;
    return -1;
  }
  void add(const AnimationChannel& channel, int animation) {
    drivers_[key(channel)].emplace_back(channel.element, animation);
  }

 private:
  static std::pair<TargetPath, int> key(const AnimationChannel& channel) { return {channel.path, channel.object}; }
  static bool names_texture(const AnimationChannel& channel) {
    return channel.path >= TargetPath::texture_offset && channel.path <= TargetPath::texture_scale;
  }
  std::map<std::pair<TargetPath, int>, std::vector<std::pair<int, int>>> drivers_;
};

int target_count(const Animation& animation) {
  std::set<std::tuple<TargetPath, int, int>> targets;
  for (const AnimationChannel& c : animation.channels) targets.emplace(c.path, c.object, c.element);
  return int(targets.size());
}

// conflicts: targets that an animation which was added before drives.
int conflicts_of(const DrivenTargets& driven, const Animation& animation, int& with) {
  int count = 0;
  for (const AnimationChannel& channel : animation.channels)
    if (const int driver = driven.driver(channel); driver >= 0) {
      if (with < 0) with = driver;
      ++count;
    }
  return count;
}

// Each in file order, unless it touches what one before it that plays touches.
AnimationChoice without_conflicts(const Scene& scene) {
  AnimationChoice choice;
  DrivenTargets driven;
  for (size_t i = 0; i < scene.animations.size(); ++i) {
    const Animation& animation = scene.animations[i];
    if (std::ranges::any_of(animation.channels, [&](const auto& channel) { return driven.driver(channel) >= 0; }))
      continue;
    choice.animations.push_back(int(i));
    if (scene.animations.size() > 1)
      for (const AnimationChannel& channel : animation.channels) driven.add(channel, int(i));
  }
  return choice;
}

}  // namespace

Expected<std::vector<ClipFacts>> clip_facts(const Scene& scene, const std::string& which) {
  const auto choice = choose_animations(scene, which);
  if (!choice) return std::unexpected(choice.error());
  std::vector<ClipFacts> clips;
  DrivenTargets driven;
  for (size_t i = 0; i < scene.animations.size(); ++i) {
    const Animation& animation = scene.animations[i];
    ClipFacts& clip = clips.emplace_back(ClipFacts{.name = animation.name, .end_s = animation.end_s});
    clip.targets = target_count(animation);
    clip.plays = std::ranges::find(choice->animations, int(i)) != choice->animations.end();
    clip.conflicts = conflicts_of(driven, animation, clip.with);
    if (which != "auto" || clip.plays)
      for (const AnimationChannel& channel : animation.channels) driven.add(channel, int(i));
  }
  return clips;
}

std::string clip_note(const Scene& scene, const std::string& which) {
  if (scene.animations.size() < 2 || (which != "auto" && which != "all")) return {};
  const auto clips = clip_facts(scene, which);
  if (!clips) return {};
  std::string names;
  size_t count = 0;
  constexpr size_t most = 6;
  for (size_t i = 0; i < clips->size(); ++i) {
    const ClipFacts& clip = (*clips)[i];
    if (clip.conflicts == 0) continue;
    if (++count > most) continue;
    const std::string name = clip.name.empty() ? fmt::format("{}", i) : quoted_name(clip.name);
    names += fmt::format("{}{} ({:.2f} s)", count > 1 ? ", " : "", name, clip.end_s);
  }
  if (count == 0) return {};
  if (count > most) names += fmt::format(" and {} more", count - most);
  if (which == "all")
    return fmt::format(
        "{} of {} animations move what one before them moves, and the last counts: {} (--animation auto "
        "plays what goes together)",
        count, clips->size(), names);
  return fmt::format(
      "{} of {} animations do not play, for they move what one before them moves: {} (--animation NAME "
      "plays one, all plays all)",
      count, clips->size(), names);
}

double clips_end_s(const Scene& scene, const AnimationChoice& choice) {
  double end_s = 0;
  for (const int i : choice.animations) end_s = std::max(end_s, scene.animations[size_t(i)].end_s);
  return scene.paths ? std::max(end_s, scene.paths->end_s) : end_s;
}

Expected<AnimationChoice> choose_animations(const Scene& scene, const std::string& which) {
  AnimationChoice choice;
  if (which == "none") return choice;
  if (which == "auto") return without_conflicts(scene);
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
  return fail(ErrorKind::usage, scene.path, "no animation '{}': {}; or give auto, all or none", which,
              animation_names(scene));
}

Pose evaluate_pose(const Scene& scene, const AnimationChoice& animations, double time_s) {
  Pose pose;
  pose.time_s = time_s;
  pose.materials = scene.materials;
  pose.lights = scene.lights;
  pose.cameras = scene.cameras;
  pose.metaballs = scene.metaballs;
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
