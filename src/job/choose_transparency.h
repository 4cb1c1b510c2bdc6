#pragma once
#include <cstdint>
#include <string>

#include "job/job.h"
#include "scene/scene.h"

namespace candela {

// --transparency auto: how blended surfaces come over each other where the job names no method.
inline constexpr std::string_view auto_transparency = "auto";

// Blended triangles, lines and points of all the scene's instances, whatever is visible at a time.
uint64_t blended_primitives(const Scene& scene);

// What a device must have for the exact method, `layers`.
struct TransparencyDevice {
  bool stores_fragments = true;  // geometryShader, and for several samples a pixel VK_EXT_post_depth_coverage
  uint64_t memory_bytes = 0;     // in all, free or not; 0: not known, no limit
};

// `layers` where the device can and a quarter of its memory holds any four pixels' surfaces and the picture's samples;
// else `moments`. A function of scene, size, samples and device alone: the same for each frame of a film. `why` is a
// sentence for the user; empty where nothing is blended (then the method is `sorted`, which draws nothing).
struct ChosenTransparency {
  std::string name, why;
};
ChosenTransparency choose_transparency(const Scene& scene, const Job& job, int samples,
                                       const TransparencyDevice& device);

}  // namespace candela
