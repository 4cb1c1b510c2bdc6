#pragma once
#include <functional>
#include <string>
#include <vector>

#include "frame/job.h"
#include "image/image.h"

namespace candela {

// What pictures are compared with. `exact` is the row's own technique at quality exact, on the GPU: a difference from
// it is what knobs leave wrong, the sampling error. The others are traced: `direct-unshadowed` shows what GPU
// techniques without shadows approximate, `direct` blocks light by what stands in its way, `path` has indirect light
// besides. How far a technique's exact picture is from them is its model error.
inline constexpr const char* exact_reference = "exact";
inline constexpr const char* open_reference_name = "direct-unshadowed";
std::vector<std::string> error_reference_names();

// A traced picture with its variance.
struct Truth {
  std::string name;
  FloatImage image;
  FloatImage divided;  // the same with the layers of error_parts.h
  uint64_t spp = 0;
  std::string failed;  // why there is none
};
struct TruthLimits {
  uint64_t spp = 64;
  double seconds = 0;  // longest time for one; 0: none
};
// All traced references of a job. Their samples are kept in the cache folder (references/*.film), by all that decides
// them: scene, camera, size, time, settings, and this program's own bytes. What is there is not traced again, and what
// was interrupted goes on.
std::vector<Truth> traced_truths(const Job& job, double time_s, const TruthLimits& limits,
                                 const std::function<bool()>& stop);

}  // namespace candela
