#ifndef CANDELA_SHARED_BLOOM_H
#define CANDELA_SHARED_BLOOM_H
#include "shared/types.h"
SHARED_BEGIN
struct BloomDownPush {
  uint source, target;
  uvec2 source_px, target_px;
  float threshold, knee;  // in the units of the linear picture
  uint64_t report;
};
struct BloomUpPush {
  uint coarse, fine, target;
  uvec2 target_px;
  float coarse_weight, fine_weight;
};
struct BloomConvolvePush {
  uint source, sum, target;
  uvec2 size_px;
  float sigma_px, weight;
  float threshold, knee;
  uint64_t report;
};
struct BloomCompositePush {
  uint color, source, bloom, composed, glow;
  uvec2 size_px;
  float strength, bloom_weight;  // bloom_weight: of the level that is half the picture
  float threshold, knee;
  uint keeps;  // 1: what is blurred is taken from where it came
  uint64_t energies;
};
struct BloomEnergyPush {
  uint64_t energies, report;
  uint count;
};
// Sums of luminance before and after, and non-finite texels that were taken for black.
struct BloomReport {
  float before, after;
  uint nonfinite;
};
SHARED_END
#ifdef __cplusplus
namespace candela::shared {
inline constexpr uint bloom_group = 64, bloom_energy_group = 256;
}
#else
const uint bloom_group = 64u, bloom_energy_group = 256u;
const uint bloom_tile = 8u;  // side of a group's texels, up and down
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer BloomReportRef { BloomReport r; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer EnergiesRef { vec2 e[]; };
#endif
#endif
