#pragma once
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>
#include <vector>

#include "scene/pose.h"

namespace candela {

// A node's own transform and visibility while channels are applied.
struct NodeState {
  glm::dvec3 translation{0}, scale{1};
  glm::dquat rotation{1, 0, 0, 0};
  bool visible = true;
};

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
