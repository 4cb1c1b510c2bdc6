#include "reference/blinn_phong.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "reference/cubic_weights.h"
#include "reference/sampling.h"
#include "scene/blinn_phong.h"

namespace candela::reference {
namespace {

using std::numbers::pi;
constexpr double least_half_cosine = 1e-7;  // a power of it is defined for every exponent
constexpr double least_blinn_roughness = 0.02;
constexpr int blinn_rows = 40, blinn_columns = 40, blinn_axis = 96;

double blinn_exponent(int i) {
  const double r = least_blinn_roughness + (1 - least_blinn_roughness) * i / (blinn_rows - 1);
  return std::max(2 / std::pow(r, 4) - 2, 0.0);
}
double blinn_cosine(int i) {
  const double at = double(i) / (blinn_columns - 1);
  return at * at;
}
const std::vector<double>& blinn_table() {
  static const std::vector<double> made = [] {
    std::vector<double> t;
    for (int r = 0; r < blinn_rows; ++r)
      for (int c = 0; c < blinn_columns; ++c)
        t.push_back(integrate_blinn_phong(blinn_exponent(r), blinn_cosine(c), blinn_axis));
    return t;
  }();
  return made;
}

}  // namespace

double blinn_phong(double n_h, double exponent) {
  const double norm = (exponent + 2) * (exponent + 4) / (8 * pi * (exponent + std::exp2(-exponent / 2)));
  return norm * std::pow(std::max(n_h, least_half_cosine), exponent);
}

double integrate_blinn_phong(double exponent, double n_v, int per_axis) {
  // Half vectors by their density: the power is in their number.
  const glm::dvec3 v(std::sqrt(std::max(1 - n_v * n_v, 0.0)), 0, n_v);
  double sum = 0;
  for (int i = 0; i < per_axis; ++i) {
    const double z = std::pow((i + 0.5) / per_axis, 1 / (exponent + 1)), across = std::sqrt(std::max(1 - z * z, 0.0));
    for (int j = 0; j < per_axis; ++j) {
      const double v_h = across * std::cos(pi * (j + 0.5) / per_axis) * v.x + z * v.z;
      sum += std::max(v_h, 0.0) * std::max(2 * v_h * z - v.z, 0.0);
    }
  }
  return blinn_phong(1, exponent) * 8 * pi / (exponent + 1) * sum / (double(per_axis) * per_axis);
}

double blinn_phong_albedo(double exponent, double n_v) {
  const double r = roughness_of_exponent(exponent);
  const CubicWeights row((r - least_blinn_roughness) / (1 - least_blinn_roughness) * (blinn_rows - 1), blinn_rows);
  const CubicWeights column(std::sqrt(std::clamp(n_v, 0.0, 1.0)) * (blinn_columns - 1), blinn_columns);
  double sum = 0;
  for (size_t i = 0; i < 4; ++i)
    for (size_t j = 0; j < 4; ++j)
      sum += row.weight[i] * column.weight[j] *
             blinn_table()[(size_t(row.first) + i) * blinn_columns + size_t(column.first) + j];
  return std::clamp(sum, 0.0, 1.0);
}

glm::dvec3 blinn_half_vector(glm::dvec3 normal, double exponent, glm::dvec2 u) {
  const double z = std::pow(1 - u.x, 1 / (exponent + 1)), across = std::sqrt(std::max(1 - z * z, 0.0)),
               phi = 2 * pi * u.y;
  glm::dvec3 x, y;
  make_frame(normal, x, y);
  return across * std::cos(phi) * x + across * std::sin(phi) * y + z * normal;
}

double blinn_pdf(double n_h, double v_h, double exponent) {
  if (!(n_h > 0) || !(v_h > 0)) return 0;
  return (exponent + 1) / (2 * pi) * std::pow(n_h, exponent) / (4 * v_h);
}

}  // namespace candela::reference
