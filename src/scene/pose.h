#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "scene/scene.h"

namespace candela {

// Which animations play: none, all, or a list of indices. They apply in file order; the last that drives a property
// wins.
struct AnimationChoice {
  std::vector<int> animations;
};
// "auto", "all", "none", an index or a name. Auto: in file order each plays unless it touches a target (an object's
// property) that one before it that plays touches. Error usage: lists the names there are.
Expected<AnimationChoice> choose_animations(const Scene& scene, const std::string& which);

// What the choice `which` means for one animation of the file.
struct ClipFacts {
  std::string name;
  double end_s = 0;
  int targets = 0;     // properties of objects that it drives
  bool plays = false;  // by `which`
  int conflicts = 0;   // how many of its targets ...
  int with = -1;       // ... this animation drives too: for auto the first before it that plays, else any before it
};
Expected<std::vector<ClipFacts>> clip_facts(const Scene& scene, const std::string& which);
// A sentence about animations that conflict: with auto, those that do not play for that reason; with all, those that
// drive what others drive. Empty without conflicts.
std::string clip_note(const Scene& scene, const std::string& which);
// The last key of what plays and the end of all paths, seconds; 0: nothing moves.
double clips_end_s(const Scene& scene, const AnimationChoice& choice);

// A scene at one time. Evaluated in double; nothing carries over from another time, so any order of frames gives the
// same.
struct Pose {
  double time_s = 0;                             // for what moves without an animation (light_instances.h)
  std::vector<glm::dmat4> world_from_node;       // per node; identity for unreachable ones
  std::vector<bool> node_visible;                // with ancestors (KHR_node_visibility)
  std::vector<std::vector<float>> node_weights;  // per node with a morphed mesh, else empty
  std::vector<Material> materials;               // copies, with animated values
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  std::vector<Metaballs> metaballs;
  std::vector<std::string> warnings;  // animated values that had to be clamped or left out, one line each
};

// time_s before the first key: its value; past the last key of a channel: the last value. No looping
// (docs/building/decisions.md).
Pose evaluate_pose(const Scene& scene, const AnimationChoice& animations, double time_s);

// One channel at one time, in double (tests compare with values by hand). out has channel.components values.
void sample_channel(const AnimationChannel& channel, double time_s, std::span<double> out);

}  // namespace candela
