#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace candela::test {

// Points and weights of Gauss and Legendre's rule on 0 to 1.
struct GaussRule {
  explicit GaussRule(int count) : at(size_t(count)), weight(size_t(count)) {
    for (int i = 0; i < count; ++i) {
      double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5)), slope = 1;
      for (int step = 0; step < 20; ++step) {  // Newton's method on the polynomial's recurrence
        double value = 1, before = 0;
        for (int j = 0; j < count; ++j) {
          const double next = ((2 * j + 1) * x * value - j * before) / (j + 1);
          before = value, value = next;
        }
        slope = count * (x * value - before) / (x * x - 1);
        x -= value / slope;
      }
      at[size_t(i)] = (1 - x) / 2, weight[size_t(i)] = 1 / ((1 - x * x) * slope * slope);
    }
  }
  std::vector<double> at, weight;
};

// The directional albedo of glTF's specular lobe as scale * f0 + bias * f90, by integration over facets. Roughness is
// perceptual and not below the BRDF's least one, 0.045.
//
// A facet's tilt t has tan t = alpha tan s, so that the distribution's mass is smooth in s; of the circle about the
// normal only the part that reflects to above the surface is walked, and the walk over s is cut where that part stops
// to be the whole circle and where it ends. Within these bounds nothing has a kink, and Gauss's rule converges fast.
struct SplitSum {
  double scale = 0, bias = 0;
};
inline SplitSum split_sum_integral(double roughness, double n_v, const GaussRule& rule) {
  constexpr double pi = std::numbers::pi;
  const double alpha = roughness * roughness, a2 = alpha * alpha;
  const double sin_v = std::sqrt(1 - n_v * n_v), angle_v = std::acos(n_v);
  const auto masked = [&](double cosine) { return std::sqrt(a2 + (1 - a2) * cosine * cosine); };
  const std::array<double, 3> cuts = {0, std::atan(std::tan(pi / 4 - angle_v / 2) / alpha),
                                      std::atan(std::tan(pi / 4 + angle_v / 2) / alpha)};
  SplitSum sum;
  for (size_t part = 0; part < 2; ++part)
    for (size_t i = 0; i < rule.at.size(); ++i) {
      // Points gather at the ends, where the part of the circle begins like a root.
      const double width = cuts[part + 1] - cuts[part];
      const double s = cuts[part] + width * (1 - std::cos(pi * rule.at[i])) / 2;
      const double ds = width * pi / 2 * std::sin(pi * rule.at[i]) * rule.weight[i];
      const double tangent = alpha * std::tan(s), n_h = 1 / std::sqrt(1 + tangent * tangent), sin_h = tangent * n_h;
      const double mass = 2 * std::sin(s) * std::cos(s) * ds;  // of D (n.h) over the whole circle
      const double end =
          std::acos(std::clamp((n_v / (2 * n_h) - n_v * n_h) / std::max(sin_v * sin_h, 1e-300), -1., 1.));
      for (size_t j = 0; j < rule.at.size(); ++j) {
        const double v_h = sin_v * sin_h * std::cos(end * rule.at[j]) + n_v * n_h, n_l = 2 * v_h * n_h - n_v;
        if (!(n_l > 0)) continue;  // on the bound itself
        const double smith = 0.5 / (n_l * masked(n_v) + n_v * masked(n_l));
        const double value = mass * (end / pi) * rule.weight[j] * smith * n_l * 4 * v_h / n_h;
        const double grazing = std::pow(1 - v_h, 5);
        sum.scale += value * (1 - grazing), sum.bias += value * grazing;
      }
    }
  return sum;
}

// The part of a white diffuse lobe's light whose half vectors' Schlick term (1 - v.h)^5 takes it, without f0 and f90:
// the integral of that term times n.l / pi over the hemisphere of l.
inline double grazing_integral(double n_v, const GaussRule& rule) {
  constexpr double pi = std::numbers::pi;
  const double sin_v = std::sqrt(1 - n_v * n_v);
  double sum = 0;
  for (size_t i = 0; i < rule.at.size(); ++i) {
    const double n_l = std::sin(pi / 2 * rule.at[i]), sin_l = std::cos(pi / 2 * rule.at[i]);
    for (size_t j = 0; j < rule.at.size(); ++j) {
      // Of unit vectors: v.h = |l + v| / 2.
      const double v_l = sin_v * sin_l * std::cos(pi * rule.at[j]) + n_v * n_l;
      const double grazing = std::pow(1 - std::sqrt(std::max((1 + v_l) / 2, 0.0)), 5);
      sum += grazing * n_l * sin_l * pi * rule.weight[i] * rule.weight[j];
    }
  }
  return sum;
}

}  // namespace candela::test
