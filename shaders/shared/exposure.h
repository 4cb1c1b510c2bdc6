#ifndef CANDELA_SHARED_EXPOSURE_H
#define CANDELA_SHARED_EXPOSURE_H
#include "shared/types.h"
SHARED_BEGIN
struct ExposureCountPush {
  uint64_t counts;
  uint source;
  uvec2 size_px;
  float scale;  // from the picture's units to radiance
};
struct ExposureMeanPush {
  uint64_t counts, result, report;
  float low, high;  // shares of the pixels
  float target, min_ev, max_ev;
};
// The factor for the picture, and its log2; how many pixels were looked at, opaque or not.
struct ExposureResult {
  float factor, ev;
  uint pixels;
};
SHARED_END
#ifdef __cplusplus
namespace candela::shared {
inline constexpr uint exposure_rows = 16;  // that a thread counts
inline constexpr float exposure_darkest_ev = -24, exposure_brightest_ev = 24;
}  // namespace candela::shared
#else
const uint exposure_rows = 16u;
const float exposure_darkest_ev = -24.0, exposure_brightest_ev = 24.0;
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer ExposureCountsRef { uint n[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer ExposureResultRef { ExposureResult r; };
#endif
#endif
