#pragma once
#include <functional>
#include <string>
#include <vector>

#include "image/image.h"
#include "job/job.h"
#include "scene/scene.h"

namespace candela {

// What pictures are compared with. `exact` is the row's own technique at quality exact, on the GPU: a difference from
// it is what knobs leave wrong, the sampling error. The others are traced: `direct-unshadowed` lets light through
// everything, `direct` blocks it by what stands in its way, `path` has indirect light besides and goes through glass
// and leaves.
inline constexpr const char* exact_reference = "exact";
inline constexpr const char* open_reference_name = "direct-unshadowed";
std::vector<std::string> error_reference_names();

// The traced reference that holds what a frame of the job claims to draw, by which settings are judged: `direct`;
// `path` where light goes through surfaces, which `direct` takes for opaque; `direct-unshadowed` where the job's
// effects leave out shadows and occlusion.
std::string claimed_reference(const Job& job, const Scene& scene);

// A traced picture with its variance.
struct Truth {
  std::string name;
  FloatImage image;
  FloatImage divided;  // the same with the layers of error_parts.h, and depth
  uint64_t spp = 0;
  double sample_s = 0;  // wall time of one sample a pixel; 0: not known, for all were kept
  std::string failed;   // why there is none
};
struct TruthLimits {
  uint64_t spp = 64;
  double seconds = 0;      // longest time for one; 0: none
  double noise = 0;        // enough where the relmse that its noise makes is below; 0: none
  bool with_parts = true;  // Truth::divided is made
};
// One moment and camera of a job.
struct TruthView {
  CameraRequest camera;
  double time_s = 0;
  uint64_t seed = 0;  // of its samples
};
// The traced references of these names in each view, read from one scene. Their samples are kept in the cache folder
// (references/*.film), by all that decides them: scene, camera, size, time, settings, and this program's own bytes.
// What is there is not traced again, and what was interrupted goes on.
std::vector<std::vector<Truth>> traced_truths(const Job& job, const std::vector<TruthView>& views,
                                              const std::vector<std::string>& names, const TruthLimits& limits,
                                              const std::function<bool()>& stop);

}  // namespace candela
