#include "reference/sheen.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "reference/cubic_weights.h"

namespace candela::reference {
namespace {

using std::numbers::pi;
constexpr int sheen_rows = 32, sheen_columns = 32, table_rings = 128;
constexpr double least_cosine = 1e-4;

double alpha_of_sheen(double roughness) {
  const double r = std::max(roughness, least_sheen_roughness);
  return r * r;
}

// The fit of Smith's lambda, between its values for straight and for tangled fibres.
struct FibreShadowing {
  explicit FibreShadowing(double alpha) {
    const double t = (1 - alpha) * (1 - alpha);
    const auto between = [&](double tangled, double straight) { return tangled + (straight - tangled) * t; };
    a = between(21.5473, 25.3245), b = between(3.82987, 3.32435), c = between(0.19823, 0.16801);
    d = between(-1.97760, -1.27393), e = between(-4.32054, -4.85967);
  }
  double exponent(double x) const { return a / (1 + b * std::pow(x, c)) + d * x + e; }
  double lambda(double cosine) const {
    const double x = std::clamp(cosine, 0.0, 1.0);
    return std::exp(x < 0.5 ? exponent(x) : 2 * exponent(0.5) - exponent(1 - x));
  }
  double a, b, c, d, e;
};

double fibre_density(double n_h, double alpha) {
  const double sine2 = std::clamp(1 - n_h * n_h, 0.0, 1.0), inverse = 1 / alpha;
  return (2 + inverse) * std::pow(sine2, inverse / 2) / (2 * pi);
}

double row_roughness(int i) { return std::pow(least_sheen_roughness, 1 - double(i) / (sheen_rows - 1)); }
// In equal steps of the fourth root.
double column_cosine(int i) {
  const double low = std::pow(least_cosine, 0.25);
  return std::min(std::pow(low + (1 - low) * i / (sheen_columns - 1), 4), 1.0);
}
const std::vector<double>& sheen_table() {
  static const std::vector<double> made = [] {
    std::vector<double> t;
    for (int r = 0; r < sheen_rows; ++r)
      for (int v = 0; v < sheen_columns; ++v)
        t.push_back(integrate_sheen(row_roughness(r), column_cosine(v), table_rings));
    return t;
  }();
  return made;
}

}  // namespace

double sheen_lobe(double n_l, double n_v, double n_h, double roughness) {
  const double alpha = alpha_of_sheen(roughness), view = std::max(n_v, least_cosine);
  const FibreShadowing s(alpha);
  return fibre_density(n_h, alpha) / ((1 + s.lambda(view) + s.lambda(n_l)) * 4 * view);
}

double integrate_sheen(double roughness, double n_v, int rings) {
  const double alpha = alpha_of_sheen(roughness), view = std::max(n_v, least_cosine);
  const FibreShadowing s(alpha);
  const double of_v = s.lambda(view), sine_v = std::sqrt(1 - view * view);
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    // Finer towards the horizon, where straight fibres shine.
    const double t = (i + 0.5) / rings, polar = pi / 2 * (1 - t * t), z = std::cos(polar), sine = std::sin(polar);
    const double weight = sine * pi * t / rings / ((1 + of_v + s.lambda(z)) * 4 * view);
    double ring = 0;
    const int sectors = rings / 2;
    for (int j = 0; j < sectors; ++j) {
      const double longitude = pi * (j + 0.5) / sectors, cosine = sine * sine_v * std::cos(longitude) + z * view;
      // |l + v|^2 = 2 + 2 l.v
      const double length2 = 2 + 2 * cosine, n_h2 = length2 > 1e-12 ? (z + view) * (z + view) / length2 : 1;
      ring += fibre_density(std::sqrt(std::min(n_h2, 1.0)), alpha);
    }
    sum += weight * ring * 2 * pi / sectors;
  }
  return sum;
}

double sheen_albedo(double roughness, double n_v) {
  const double low = std::pow(least_cosine, 0.25);
  const double r = std::clamp(roughness, least_sheen_roughness, 1.0);
  const CubicWeights rows((1 - std::log(r) / std::log(least_sheen_roughness)) * (sheen_rows - 1), sheen_rows);
  const CubicWeights columns(
      (std::pow(std::clamp(n_v, least_cosine, 1.0), 0.25) - low) / (1 - low) * (sheen_columns - 1), sheen_columns);
  double sum = 0;
  for (size_t r = 0; r < 4; ++r)
    for (size_t c = 0; c < 4; ++c)
      sum += rows.weight[r] * columns.weight[c] *
             sheen_table()[(size_t(rows.first) + r) * sheen_columns + size_t(columns.first) + c];
  return std::max(sum, 0.0);
}

}  // namespace candela::reference
