#pragma once
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "scene/pose.h"

namespace candela {

// A node's own transform and visibility while channels are applied.
struct NodeState {
  glm::dvec3 translation{0}, scale{1};
  glm::dquat rotation{1, 0, 0, 0};
  bool visible = true;
};

// What the specification allows a property that a channel drives.
struct PropertyRange {
  std::string_view name;
  double lowest = -std::numeric_limits<double>::infinity(), highest = std::numeric_limits<double>::infinity();
};
PropertyRange range_of(TargetPath path);
// "/extensions/KHR_lights_punctual/lights/3 'Torch'", for messages.
std::string light_place(const Scene& scene, size_t light);
inline bool drives_light(TargetPath path) {
  return path >= TargetPath::light_color && path <= TargetPath::light_outer_cone;
}

// Where a channel's value goes, and what a warning says about it.
struct AnimationTarget {
  const Scene& scene;
  Pose& pose;
  std::vector<NodeState>& nodes;
  const Animation* animation;
  double time_s;
};

// Writes the sampled values of one channel. Values outside the range that the property has in the specification are
// clamped into it (as KHR_animation_pointer asks), non-finite ones leave the file's own value (an intensity: 0), each
// with a warning.
void apply_channel(AnimationTarget& target, const AnimationChannel& channel, std::span<const double> values);

}  // namespace candela
