#pragma once
#include <cmath>
#include <functional>
#include <span>
#include <vector>

namespace candela {

// A float plane of width*height, rows from the top.
using Plane = std::vector<float>;

// The curve of IEC 61966-2-1, and back.
inline float srgb_from_linear(float v) {
  return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
}
inline float linear_from_srgb(float s) { return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f); }

// Sum over the rows of row_sum(y): rows in parallel, added in order.
double sum_rows(int height, const std::function<double(int y)>& row_sum);

// Separable correlation with kernels of odd length along x and y; pixels beyond the edge repeat the edge.
Plane filter_separable(const Plane& plane, int width, int height, std::span<const float> kernel_x,
                       std::span<const float> kernel_y);

}  // namespace candela
