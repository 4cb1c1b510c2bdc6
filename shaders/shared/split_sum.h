#ifndef CANDELA_SHARED_SPLIT_SUM_H
#define CANDELA_SHARED_SPLIT_SUM_H
#include "shared/types.h"

// The texture of the split sum (sky/split_sum.h makes it, lib/ambient.glsl reads it): columns in equal steps of the
// root of n.v from 0 to 1, rows in equal steps of the root of perceptual roughness from its least to 1.
//
// Perceptual roughness below the least counts as it: D overflows at its peak in 32-bit floats else.
#ifdef __cplusplus
namespace candela::shared {
inline constexpr uint split_sum_columns = 64, split_sum_rows = 32;
inline constexpr double least_roughness = 0.045;
}  // namespace candela::shared
#else
const uint split_sum_columns = 64, split_sum_rows = 32;
const float least_roughness = 0.045;
#endif

#endif
