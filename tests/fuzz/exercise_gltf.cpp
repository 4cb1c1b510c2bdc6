#include "exercise.h"

#include "gltf/gltf.h"
#include "scene/frame_data.h"
#include "scene/pose.h"
#include "scene/survey.h"

namespace candela::fuzz {

bool exercise(std::span<const std::byte> bytes) {
  const Expected<Scene> scene = load_gltf_from_memory(bytes, "input.gltf", "no-such-folder", LoadFor::path_tracing);
  if (!scene) return false;
  const Expected<AnimationChoice> all = choose_animations(*scene, "all");
  for (const double time_s : {-1.0, 0.5, 1e9}) {
    const Pose pose = evaluate_pose(*scene, all ? *all : AnimationChoice{}, time_s);
    world_bounds(*scene, pose);
    make_frame_data(*scene, pose, View{});
  }
  return true;
}

}  // namespace candela::fuzz
