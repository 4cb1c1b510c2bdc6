#pragma once
#include <array>
#include <cstdint>

#include "shared/split_sum.h"

namespace candela {

// Directional albedo of glTF's BRDF under a uniform sky, single scattering: what the split sum takes for light from all
// around (Karis, "Real Shading in Unreal Engine 4", 2013; height-correlated Smith by Heitz 2014). Per row of roughness
// and column of n.v the pair scale, bias: the specular lobe reflects f0 * scale + f90 * bias. Per column also what the
// half vectors' Schlick term takes of a diffuse lobe. 65535 is 1. Axes: shared/split_sum.h.
//
// Between its places the bilinear table is within 0.002 of the scale's integral and 0.004 of the bias's, 0.0003 in the
// mean; within 0.6 degrees of grazing, where the lobes of smooth surfaces bend most, 0.009.
//
// tests/unit/frame_split_sum.cpp makes every number again, and prints the table where one differs.
extern const std::array<uint16_t, 2 * shared::split_sum_columns * shared::split_sum_rows> split_sum_table;
extern const std::array<uint16_t, shared::split_sum_columns> split_sum_grazing;

}  // namespace candela
