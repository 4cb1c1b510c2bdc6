#version 460
// The mean log2 of the luminance between two percentiles of a histogram, and the factor that takes it to the target:
// one thread, bin after bin.
#include "shared/exposure.h"
layout(push_constant, scalar) uniform Push { ExposureMeanPush pc; };
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const uint BINS = 256u;

void main() {
  if (gl_GlobalInvocationID.x != 0u) return;
  uint pixels = 0u;
  for (uint i = 0u; i < BINS; ++i) pixels += ExposureCountsRef(pc.counts).n[i];
  const float low = pc.low * float(pixels), high = pc.high * float(pixels);
  const float bin_ev = (exposure_brightest_ev - exposure_darkest_ev) / float(BINS);
  uint before = 0u;
  float weights = 0.0, sum = 0.0;
  for (uint i = 0u; i < BINS; ++i) {
    const uint until = before + ExposureCountsRef(pc.counts).n[i];
    const float weight = max(min(float(until), high) - max(float(before), low), 0.0);
    weights += weight;
    sum += weight * (exposure_darkest_ev + (float(i) + 0.5) * bin_ev);
    before = until;
  }
  ExposureResult result = ExposureResult(1.0, 0.0, pixels);
  if (weights > 0.0) {
    result.ev = clamp(log2(pc.target) - sum / weights, pc.min_ev, pc.max_ev);
    result.factor = exp2(result.ev);
  }
  ExposureResultRef(pc.result).r = result;
  ExposureResultRef(pc.report).r = result;
}
