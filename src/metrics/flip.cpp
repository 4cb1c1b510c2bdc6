#include "metrics/flip.h"

#include <tbb/parallel_for.h>

#include <numbers>

#include "base/statistics.h"

namespace candela {
namespace {

using Triple = std::array<float, 3>;

// Linear Rec.709 to CIE XYZ, D65, from the primaries of IEC 61966-2-1; and its inverse.
constexpr double xyz_from_rgb[3][3] = {{0.4123907992659595, 0.357584339383878, 0.1804807884018343},
                                       {0.21263900587151027, 0.715168678767756, 0.07219231536073371},
                                       {0.01933081871559182, 0.11919477979462598, 0.9505321522496607}};
constexpr double rgb_from_xyz[3][3] = {{3.2409699419045226, -1.537383177570094, -0.4986107602930034},
                                       {-0.9692436362808796, 1.8759675015077202, 0.04155505740717559},
                                       {0.05563007969699366, -0.20397695888897652, 1.0569715142428786}};

Triple multiply(const double (&m)[3][3], const Triple& v) {
  Triple result;
  for (int r = 0; r < 3; ++r) result[r] = float(m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2]);
  return result;
}

constexpr double white(int row) { return xyz_from_rgb[row][0] + xyz_from_rgb[row][1] + xyz_from_rgb[row][2]; }
constexpr Triple white_point = {float(white(0)), float(white(1)), float(white(2))};

// YCxCz: CIELAB without the cube root, so that filtering stays linear in light (paper, section 4.1).
Triple ycxcz_from_linear(const Triple& rgb) {
  Triple t = multiply(xyz_from_rgb, rgb);
  for (int i = 0; i < 3; ++i) t[i] /= white_point[i];
  return {116 * t[1] - 16, 500 * (t[0] - t[1]), 200 * (t[1] - t[2])};
}

Triple linear_from_ycxcz(const Triple& c) {
  const float y = (c[0] + 16) / 116;
  return multiply(rgb_from_xyz,
                  {(y + c[1] / 500) * white_point[0], y * white_point[1], (y - c[2] / 200) * white_point[2]});
}

// CIELAB with the Hunt effect: chroma fades with lightness (paper, section 4.1.2).
Triple hunt_lab_from_linear(const Triple& rgb) {
  Triple t = multiply(xyz_from_rgb, rgb);
  for (int i = 0; i < 3; ++i) {
    constexpr float delta = 6.0f / 29.0f;
    const float ratio = t[i] / white_point[i];
    t[i] = ratio > delta * delta * delta ? std::cbrt(ratio) : ratio / (3 * delta * delta) + 4.0f / 29.0f;
  }
  const float lightness = 116 * t[1] - 16;
  return {lightness, 0.01f * lightness * 500 * (t[0] - t[1]), 0.01f * lightness * 200 * (t[1] - t[2])};
}

float hyab(const Triple& a, const Triple& b) { return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]); }

// Two weighted Gaussians a*sqrt(pi/b)*exp(-(pi x)^2/b), x in degrees: the contrast sensitivity of the eye in space.
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr Sensitivity sensitivities[3] = {{1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}};

// A sum of two Gaussians is not separable, each of them is: filtered apart and added with the weights of the whole
// kernel.
struct WeightedKernel {
  std::vector<float> kernel;  // sums to 1
  float weight;
};
std::vector<WeightedKernel> sensitivity_kernels(const Sensitivity& s, double pixels_per_degree) {
  using std::numbers::pi;
  const int radius = int(std::ceil(3 * std::sqrt(sensitivities[2].b1 / (2 * pi * pi)) * pixels_per_degree));
  std::vector<WeightedKernel> kernels;
  std::vector<double> totals;
  for (const auto& [a, b] : {std::pair(s.a1, s.b1), std::pair(s.a2, s.b2)}) {
    if (a == 0) continue;
    std::vector<double> values;
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) {
      const double degrees = i / pixels_per_degree;
      sum += values.emplace_back(std::exp(-pi * pi * degrees * degrees / b));
    }
    WeightedKernel& kernel = kernels.emplace_back();
    for (const double value : values) kernel.kernel.push_back(float(value / sum));
    totals.push_back(a * std::sqrt(pi / b) * sum * sum);
  }
  double whole = 0;
  for (const double total : totals) whole += total;
  for (size_t i = 0; i < kernels.size(); ++i) kernels[i].weight = float(totals[i] / whole);
  return kernels;
}

std::vector<Plane> linear_planes(const std::vector<Plane>& srgb, int width, int height) {
  std::vector<Plane> result(3, Plane(srgb[0].size()));
  tbb::parallel_for(0, height, [&](int y) {
    for (size_t k = 0; k < 3; ++k)
      for (size_t i = size_t(y) * size_t(width), end = i + size_t(width); i < end; ++i)
        result[k][i] = linear_from_srgb(srgb[k][i]);
  });
  return result;
}

std::vector<Plane> ycxcz_planes(const std::vector<Plane>& linear, int width, int height) {
  std::vector<Plane> result(3, Plane(linear[0].size()));
  tbb::parallel_for(0, height, [&](int y) {
    for (size_t i = size_t(y) * size_t(width), end = i + size_t(width); i < end; ++i) {
      const Triple c = ycxcz_from_linear({linear[0][i], linear[1][i], linear[2][i]});
      for (size_t k = 0; k < 3; ++k) result[k][i] = c[k];
    }
  });
  return result;
}

// What the eye makes of an image: each opponent channel blurred by its sensitivity, then in Hunt-adjusted CIELAB.
std::vector<Plane> perceived(const std::vector<Plane>& ycxcz, int width, int height, double pixels_per_degree) {
  std::vector<Plane> blurred(3, Plane(ycxcz[0].size()));
  for (size_t c = 0; c < 3; ++c)
    for (const WeightedKernel& part : sensitivity_kernels(sensitivities[c], pixels_per_degree)) {
      const Plane plane = filter_separable(ycxcz[c], width, height, part.kernel, part.kernel);
      for (size_t i = 0; i < plane.size(); ++i) blurred[c][i] += part.weight * plane[i];
    }
  tbb::parallel_for(0, height, [&](int y) {
    for (size_t i = size_t(y) * size_t(width), end = i + size_t(width); i < end; ++i) {
      Triple rgb = linear_from_ycxcz({blurred[0][i], blurred[1][i], blurred[2][i]});
      for (float& v : rgb) v = std::clamp(v, 0.0f, 1.0f);
      const Triple lab = hunt_lab_from_linear(rgb);
      for (size_t k = 0; k < 3; ++k) blurred[k][i] = lab[k];
    }
  });
  return blurred;
}

// Strength of edges and of points, each the length of the (first, second) derivative's vector.
struct Features {
  Plane edges, points;
};
Features features(const Plane& achromatic, int width, int height, double pixels_per_degree) {
  const double sigma = 0.5 * 0.082 * pixels_per_degree;
  const int radius = int(std::ceil(3 * sigma));
  std::vector<double> values[3];  // Gaussian, first and second derivative
  double positive[3] = {}, negative[3] = {};
  for (int i = -radius; i <= radius; ++i) {
    const double g = std::exp(-i * i / (2 * sigma * sigma));
    const double at[3] = {g, -i * g, (i * i / (sigma * sigma) - 1) * g};
    for (int k = 0; k < 3; ++k) {
      values[k].push_back(at[k]);
      (at[k] > 0 ? positive : negative)[k] += std::abs(at[k]);
    }
  }
  std::vector<float> kernels[3];  // the positive weights sum to 1, the negative ones to -1
  for (int k = 0; k < 3; ++k)
    for (const double v : values[k]) kernels[k].push_back(float(v > 0 ? v / positive[k] : v < 0 ? v / negative[k] : 0));
  const auto strength = [&](const std::vector<float>& derivative) {
    Plane x = filter_separable(achromatic, width, height, derivative, kernels[0]);
    const Plane y = filter_separable(achromatic, width, height, kernels[0], derivative);
    for (size_t i = 0; i < x.size(); ++i) x[i] = std::sqrt(x[i] * x[i] + y[i] * y[i]);
    return x;
  };
  return {strength(kernels[1]), strength(kernels[2])};
}

// Colour differences squeezed to [0,1]: those below 0.4 of the largest fill [0, 0.95], as small ones matter most.
float colour_error(float distance, float largest) {
  constexpr float knee = 0.4f, value_at_knee = 0.95f;
  const float error = std::pow(distance, 0.7f), limit = knee * largest;
  return error < limit ? error * value_at_knee / limit
                       : value_at_knee + (error - limit) / (largest - limit) * (1 - value_at_knee);
}

}  // namespace

Plane flip_map(const std::vector<Plane>& reference, const std::vector<Plane>& test, int width, int height,
               double pixels_per_degree) {
  return flip_map_of_linear(linear_planes(reference, width, height), linear_planes(test, width, height), width, height,
                            pixels_per_degree);
}

Plane flip_map_of_linear(const std::vector<Plane>& reference, const std::vector<Plane>& test, int width, int height,
                         double pixels_per_degree) {
  const std::vector<Plane> a = ycxcz_planes(reference, width, height), b = ycxcz_planes(test, width, height);
  const std::vector<Plane> lab_a = perceived(a, width, height, pixels_per_degree);
  const std::vector<Plane> lab_b = perceived(b, width, height, pixels_per_degree);
  const auto achromatic = [](const Plane& y) {
    Plane result(y.size());
    for (size_t i = 0; i < y.size(); ++i) result[i] = (y[i] + 16) / 116;
    return result;
  };
  const Features feature_a = features(achromatic(a[0]), width, height, pixels_per_degree);
  const Features feature_b = features(achromatic(b[0]), width, height, pixels_per_degree);
  const float largest = std::pow(hyab(hunt_lab_from_linear({0, 1, 0}), hunt_lab_from_linear({0, 0, 1})), 0.7f);
  Plane map(a[0].size());
  tbb::parallel_for(0, height, [&](int y) {
    for (size_t i = size_t(y) * size_t(width), end = i + size_t(width); i < end; ++i) {
      const float distance = hyab({lab_a[0][i], lab_a[1][i], lab_a[2][i]}, {lab_b[0][i], lab_b[1][i], lab_b[2][i]});
      const float feature = std::max(std::abs(feature_a.edges[i] - feature_b.edges[i]),
                                     std::abs(feature_a.points[i] - feature_b.points[i]));
      const float feature_error = std::sqrt(feature / std::numbers::sqrt2_v<float>);
      map[i] = std::clamp(std::pow(colour_error(distance, largest), 1 - feature_error), 0.0f, 1.0f);
    }
  });
  return map;
}

double flip_mean(const Plane& map, int width, int height) {
  const double sum = sum_rows(height, [&](int y) {
    double of_row = 0;
    for (int x = 0; x < width; ++x) of_row += map[size_t(y) * size_t(width) + size_t(x)];
    return of_row;
  });
  return sum / (double(width) * double(height));
}

double flip_percentile(const Plane& map, double fraction) {
  const std::vector<double> values(map.begin(), map.end());
  return percentile(values, fraction);
}

}  // namespace candela
