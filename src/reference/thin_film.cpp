#include "reference/thin_film.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace candela::reference {
namespace {

using std::numbers::pi;
// The phase turns where the base's index passes the film's; the base's comes from a rounded f0, so that indices nearer
// than this part are equal.
constexpr double least_step = 1e-5;

double reflectance_at_normal(double behind, double before) {
  const double r = (behind - before) / (behind + before);
  return r * r;
}
double schlick(double f0, double cosine) { return f0 + (1 - f0) * std::pow(std::clamp(1 - cosine, 0.0, 1.0), 5); }

// Interference of waves that are `path_nm` apart and shifted by an angle in each channel: normal distributions fitted
// to the colour matching functions of the CIE, transformed; XYZ to linear Rec. 709.
glm::dvec3 sensitivity(double path_nm, glm::dvec3 shift) {
  // Behind this path all is washed out, and it may be infinite.
  const double phase = 2 * pi * 1e-9 * std::min(path_nm, 1e7), phase2 = phase * phase;
  const auto wave = [&](double value, double position, double variance, double angle) {
    return value * std::sqrt(2 * pi * variance) * std::cos(position * phase + angle) * std::exp(-phase2 * variance);
  };
  const double x = wave(5.4856e-13, 1.6810e6, 4.3278e9, shift.x) + wave(9.7470e-14, 2.2399e6, 4.5282e9, shift.x);
  const double y = wave(4.4201e-13, 1.7953e6, 9.3046e9, shift.y), z = wave(5.2481e-13, 2.2084e6, 6.6121e9, shift.z);
  const glm::dmat3 rec709_from_xyz(3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314,
                                   0.0415560, 1.0572252);
  return rec709_from_xyz * glm::dvec3(x, y, z) / 1.0685e-7;
}

}  // namespace

glm::dvec3 film_reflectance(double cosine, double ior, double thickness_nm, glm::dvec3 f0) {
  const double c = std::clamp(cosine, 0.0, 1.0);
  // A film thinner than this fades to air.
  const double t = std::clamp(thickness_nm / 0.03, 0.0, 1.0), there = t * t * (3 - 2 * t);
  const double film = 1 + (std::clamp(ior, 1.0, 1e9) - 1) * there;
  const double inside = std::sqrt(std::max(1 - (1 - c * c) / (film * film), 0.0));
  // Into the film and out of it again.
  const double r12 = schlick(reflectance_at_normal(film, 1), c), t121 = 1 - r12;
  glm::dvec3 shift(pi), rs(0), r123(0);
  glm::dvec3 sum(0);
  for (int i = 0; i < 3; ++i) {
    const double root = std::sqrt(std::clamp(f0[i], 0.0, 0.9999)), base = (1 + root) / (1 - root);
    const double r23 = schlick(reflectance_at_normal(base, film), inside);
    if (base < film * (1 - least_step)) shift[i] += pi;
    const double both = std::clamp(r12 * r23, 1e-5, 0.9999);
    rs[i] = t121 * t121 * r23 / (1 - both);
    r123[i] = std::sqrt(both);
    sum[i] = r12 + rs[i];
  }
  const double path_nm = 2 * film * std::min(thickness_nm, 1e9) * inside;
  glm::dvec3 amplitude = rs - t121;
  for (int m = 1; m <= 2; ++m) {
    amplitude *= r123;
    sum += amplitude * 2.0 * sensitivity(m * path_nm, double(m) * shift);
  }
  return glm::clamp(sum, glm::dvec3(0), glm::dvec3(1));
}

}  // namespace candela::reference
