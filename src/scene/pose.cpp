#include "scene/pose.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "base/names.h"
#include "scene/posed_parts.h"
#include "scene/scene_path.h"

namespace candela {
namespace {

std::string animation_names(const Scene& scene) {
  if (scene.animations.empty()) return "the file has no animations";
  std::string names = "there are";
  for (size_t i = 0; i < scene.animations.size(); ++i)
    names += fmt::format("{} {} {}", i ? "," : "", i, quoted_name(scene.animations[i].name));
  return names;
}

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
  PoseState state;
  evaluate_pose(scene, posed_parts(scene, animations), time_s, state, pose);
  return pose;
}

}  // namespace candela
