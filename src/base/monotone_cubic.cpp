#include "base/monotone_cubic.h"

#include <algorithm>

namespace candela {
namespace {

double slope(std::span<const double> place, std::span<const double> value, size_t i) {
  return (value[i + 1] - value[i]) / (place[i + 1] - place[i]);
}
double tangent(std::span<const double> place, std::span<const double> value, size_t i) {
  if (i == 0) return slope(place, value, 0);
  if (i + 1 == place.size()) return slope(place, value, i - 1);
  const double before = slope(place, value, i - 1), after = slope(place, value, i);
  if (!(before * after > 0)) return 0;
  const double h0 = place[i] - place[i - 1], h1 = place[i + 1] - place[i];
  return 3 * (h0 + h1) / ((2 * h1 + h0) / before + (h1 + 2 * h0) / after);
}

}  // namespace

double monotone_cubic(std::span<const double> place, std::span<const double> value, size_t i, double x) {
  const double a = value[i], b = value[i + 1], h = place[i + 1] - place[i], s = (x - place[i]) / h;
  const double s2 = s * s, s3 = s2 * s;
  const double v = (2 * s3 - 3 * s2 + 1) * a + (s3 - 2 * s2 + s) * h * tangent(place, value, i) +
                   (3 * s2 - 2 * s3) * b + (s3 - s2) * h * tangent(place, value, i + 1);
  return std::clamp(v, std::min(a, b), std::max(a, b));  // rounding alone
}

}  // namespace candela
