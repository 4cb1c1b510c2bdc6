#include "metrics/ssim.h"

namespace candela {
namespace {

constexpr int radius = 5;

Plane luma(const std::vector<Plane>& rgb) {
  Plane y(rgb[0].size());
  for (size_t i = 0; i < y.size(); ++i) y[i] = 0.2126f * rgb[0][i] + 0.7152f * rgb[1][i] + 0.0722f * rgb[2][i];
  return y;
}

std::array<float, 2 * radius + 1> gaussian() {
  std::array<double, 2 * radius + 1> weights;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) sum += weights[size_t(i + radius)] = std::exp(-i * i / (2 * 1.5 * 1.5));
  std::array<float, 2 * radius + 1> kernel;
  for (size_t i = 0; i < kernel.size(); ++i) kernel[i] = float(weights[i] / sum);
  return kernel;
}

Plane product(const Plane& a, const Plane& b) {
  Plane p(a.size());
  for (size_t i = 0; i < p.size(); ++i) p[i] = a[i] * b[i];
  return p;
}

}  // namespace

double ssim(const std::vector<Plane>& reference, const std::vector<Plane>& test, int width, int height) {
  const auto kernel = gaussian();
  const auto blur = [&](const Plane& plane) { return filter_separable(plane, width, height, kernel, kernel); };
  const Plane a = luma(reference), b = luma(test);
  const Plane mean_a = blur(a), mean_b = blur(b);
  const Plane square_a = blur(product(a, a)), square_b = blur(product(b, b)), mixed = blur(product(a, b));
  const int margin_x = width > 2 * radius ? radius : 0, margin_y = height > 2 * radius ? radius : 0;
  const int rows = height - 2 * margin_y, columns = width - 2 * margin_x;
  const double sum = sum_rows(rows, [&](int row) {
    constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    double of_row = 0;
    for (int x = margin_x; x < width - margin_x; ++x) {
      const size_t i = size_t(row + margin_y) * size_t(width) + size_t(x);
      const double ma = mean_a[i], mb = mean_b[i];
      const double variance_a = square_a[i] - ma * ma, variance_b = square_b[i] - mb * mb,
                   covariance = mixed[i] - ma * mb;
      of_row +=
          (2 * ma * mb + c1) * (2 * covariance + c2) / ((ma * ma + mb * mb + c1) * (variance_a + variance_b + c2));
    }
    return of_row;
  });
  return sum / (double(rows) * double(columns));
}

}  // namespace candela
