#include "metrics/planes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <numeric>

#include "base/check.h"

namespace candela {

double sum_rows(int height, const std::function<double(int y)>& row_sum) {
  std::vector<double> sums(static_cast<size_t>(height));
  tbb::parallel_for(0, height, [&](int y) { sums[size_t(y)] = row_sum(y); });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

Plane filter_separable(const Plane& plane, int width, int height, std::span<const float> kernel_x,
                       std::span<const float> kernel_y) {
  CHECK(kernel_x.size() % 2 == 1 && kernel_y.size() % 2 == 1);
  const int radius_x = int(kernel_x.size() / 2), radius_y = int(kernel_y.size() / 2);
  const size_t stride = size_t(width);
  Plane across(plane.size()), result(plane.size());
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 8), [&](const tbb::blocked_range<int>& rows) {
    std::vector<float> padded(stride + 2 * size_t(radius_x));
    for (int y = rows.begin(); y < rows.end(); ++y) {
      const float* row = &plane[size_t(y) * stride];
      float* out = &across[size_t(y) * stride];
      std::fill_n(padded.begin(), radius_x, row[0]);
      std::copy_n(row, width, padded.begin() + radius_x);
      std::fill_n(padded.end() - radius_x, radius_x, row[width - 1]);
      for (size_t k = 0; k < kernel_x.size(); ++k)
        for (int x = 0; x < width; ++x) out[x] += kernel_x[k] * padded[size_t(x) + k];
    }
  });
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 8), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) {
      float* out = &result[size_t(y) * stride];
      for (int k = -radius_y; k <= radius_y; ++k) {
        const float weight = kernel_y[size_t(k + radius_y)];
        const float* row = &across[size_t(std::clamp(y + k, 0, height - 1)) * stride];
        for (int x = 0; x < width; ++x) out[x] += weight * row[x];
      }
    }
  });
  return result;
}

}  // namespace candela
