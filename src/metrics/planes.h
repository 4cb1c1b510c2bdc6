#pragma once
#include <functional>
#include <span>
#include <vector>

namespace candela {

// A float plane of width*height, rows from the top.
using Plane = std::vector<float>;

// Sum over the rows of row_sum(y): rows in parallel, added in order.
double sum_rows(int height, const std::function<double(int y)>& row_sum);

// Separable correlation with kernels of odd length along x and y; pixels beyond the edge repeat the edge.
Plane filter_separable(const Plane& plane, int width, int height, std::span<const float> kernel_x,
                       std::span<const float> kernel_y);

}  // namespace candela
