#pragma once
#include <cstdint>
#include <vector>

#include "scene/animation_targets.h"
#include "scene/frame_data.h"
#include "scene/pose.h"

namespace candela {

// What some animations drive of a scene, found once: a pose that is evaluated again sets anew what changes, and leaves
// the rest as it is.
struct PosedParts {
  enum class Kind : uint8_t { node, material, light, camera, metaballs };
  struct Part {  // an object that is driven
    Kind kind;
    uint32_t object;
    std::vector<float> weights;  // of a node, as the file has them
  };
  struct Channel {
    const Animation* animation;
    const AnimationChannel* channel;
    uint32_t part;
  };
  AnimationChoice choice;
  std::vector<Part> parts;
  std::vector<Channel> channels;      // as they apply: of animations in file order
  std::vector<int> part_of_node;      // -1: not driven
  std::vector<uint8_t> below_parent;  // of each node, whether its parent's place counts
  uint64_t id = 0;                    // no other parts have it
};
PosedParts posed_parts(const Scene& scene, const AnimationChoice& choice);

// Beside a pose, what evaluates it at another time.
struct PoseState {
  uint64_t parts = 0;            // the pose is theirs, as the function below left it; 0: of no parts
  std::vector<NodeState> nodes;  // before their transforms are composed
  std::vector<size_t> held;      // of each channel the key whose value it holds
  std::vector<uint8_t> changed;  // of each part
  std::vector<uint8_t> placed;   // of each node
  std::vector<double> values;    // of a channel
};
// As evaluate_pose(scene, parts.choice, time_s). pose: whatever it held, its memory is used again, and what it holds by
// these parts stays where time does not change it. The scene is the one that the parts are of.
void evaluate_pose(const Scene& scene, const PosedParts& parts, double time_s, PoseState& state, Pose& pose);

// make_frame_data() into `data`: whatever it held, its memory is used again.
void fill_frame_data(const Scene& scene, const Pose& pose, const View& view, double lamp_radius_m,
                     const DevicePose& on_device, double cells, FrameData& data);

}  // namespace candela
