#include "reference/albedo.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "reference/brdf.h"
#include "reference/cubic_weights.h"
#include "reference/microfacet.h"
#include "reference/sampling.h"

namespace candela::reference {
namespace {

// Nodes in equal steps of the logarithm of roughness and of the cube root of n.v: lobes keep their shape when both
// shrink together.
constexpr int roughness_nodes = 24, view_nodes = 40, per_axis = 48;
using std::numbers::pi;
constexpr double least_view = 1e-4;

double node_roughness(int i) { return std::pow(least_roughness, 1 - double(i) / (roughness_nodes - 1)); }
double node_view(int i) {
  const double low = std::cbrt(least_view), at = low + (1 - low) * i / (view_nodes - 1);
  return std::min(at * at * at, 1.0);
}

using Table = std::vector<DirectionalAlbedo>;
const Table& table() {
  static const Table made = [] {
    Table t(size_t(roughness_nodes) * view_nodes);
    for (int r = 0; r < roughness_nodes; ++r)
      for (int v = 0; v < view_nodes; ++v)
        t[size_t(r * view_nodes + v)] = integrate_albedo(node_roughness(r), node_view(v), per_axis);
    return t;
  }();
  return made;
}

}  // namespace

DirectionalAlbedo integrate_albedo(double roughness, double n_v, int count) {
  const double r = std::max(roughness, least_roughness), alpha = r * r, view = std::max(n_v, least_view);
  const glm::dvec3 n(0, 0, 1), v(std::sqrt(1 - view * view), 0, view);
  DirectionalAlbedo sum;
  for (int i = 0; i < count; ++i) {
    // Rings of the disc in equal steps of the angle whose sine is the radius: in it the root at the rim is none.
    const double step = pi / 2 / count, angle = step * (i + 0.5), radius2 = std::pow(std::sin(angle), 2);
    const double ring = std::pow(std::sin(step * (i + 1)), 2) - std::pow(std::sin(step * i), 2);
    const double weight = ring / (count / 2);
    // Half of the disc: v lies in the plane that cuts it in two.
    for (int j = 0; j < count / 2; ++j) {
      const glm::dvec2 u(radius2, (j + 0.5) / count - 0.25);
      const glm::dvec3 h = visible_normal(n, v, alpha, u);
      const double v_h = glm::dot(v, h), n_l = 2 * v_h * h.z - view;
      if (n_l > 0 && v_h > 0) {
        // D V n.l over the density G1 D / (4 n.v).
        const double value = weight * 4 * smith_v(n_l, view, alpha) * n_l * view / smith_g1(view, alpha);
        const double schlick = std::pow(1 - v_h, 5);
        sum.scale += value * (1 - schlick), sum.bias += value * schlick;
      }
      const double phi = 2 * pi * (j + 0.5) / count;
      const glm::dvec3 l(std::sin(angle) * std::cos(phi), std::sin(angle) * std::sin(phi), std::cos(angle));
      sum.grazing += weight * std::pow(std::clamp(1 - glm::dot(v, glm::normalize(l + v)), 0.0, 1.0), 5);
    }
  }
  return sum;
}

DirectionalAlbedo directional_albedo(double roughness, double n_v) {
  const double low = std::cbrt(least_view);
  const CubicWeights rows(
      (1 - std::log(std::max(roughness, least_roughness)) / std::log(least_roughness)) * (roughness_nodes - 1),
      roughness_nodes);
  const CubicWeights columns((std::cbrt(std::max(n_v, least_view)) - low) / (1 - low) * (view_nodes - 1), view_nodes);
  DirectionalAlbedo out;
  for (size_t r = 0; r < 4; ++r)
    for (size_t c = 0; c < 4; ++c) {
      const double weight = rows.weight[r] * columns.weight[c];
      const DirectionalAlbedo& node = table()[(size_t(rows.first) + r) * view_nodes + size_t(columns.first) + c];
      out.scale += weight * node.scale, out.bias += weight * node.bias, out.grazing += weight * node.grazing;
    }
  return out;
}

namespace {

// share: cosine of the view where facets are as those of roughness 1.
glm::dvec3 gain_of(glm::dvec3 f0, double alpha, double fraction) {
  // Rows by powers of alpha from 0, columns by powers of the fraction from 1.
  static constexpr double fit[4][6] = {{0.25913, -0.826616, 3.97086, -8.91993, 9.34809, -3.83096},
                                       {0.000180769, 1.85641, -5.33695, 5.53192, -1.18695, -0.926116},
                                       {4.20931, -18.1444, 36.7748, -29.5164, -0.449344, 8.6848},
                                       {-0.24951, 3.01914, 13.3698, -53.0425, 65.411, -27.7572}};
  double sum = 0;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 6; ++column)
      sum += fit[row][column] * std::pow(alpha, row) * std::pow(fraction, column + 1);
  return 1.0 + f0 * sum;
}

}  // namespace

glm::dvec3 specular_gain(glm::dvec3 f0, double roughness, double n_v) {
  const double r = std::max(roughness, least_roughness), alpha = r * r, view = std::max(n_v, least_view);
  return gain_of(f0, alpha, view / std::sqrt(view * view * (1 - alpha * alpha) + alpha * alpha));
}

double mean_alpha(const StretchedFacets& f) {
  return std::sqrt(0.39 * f.alpha.x * f.alpha.x + 0.61 * f.alpha.y * f.alpha.y);
}

glm::dvec3 specular_gain(glm::dvec3 f0, const StretchedFacets& f, glm::dvec3 v) {
  const double along = f.alpha.x, across = f.alpha.y, v_y = glm::dot(f.y, v);
  const glm::dvec3 stretched = glm::normalize(
      glm::dvec3(along * glm::dot(f.x, v), across * v_y, std::max(std::abs(glm::dot(f.z, v)), least_view)));
  // The part of the rougher axis in alpha squared.
  const double part = 0.431 + 0.177 * std::abs(stretched.y) - 0.085 * across / along * v_y * v_y +
                      (1 - along) * (0.168 - 0.35 * std::abs(stretched.x));
  return gain_of(f0, std::sqrt(part * along * along + (1 - part) * across * across), stretched.z);
}

}  // namespace candela::reference
