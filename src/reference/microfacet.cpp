#include "reference/microfacet.h"

#include <cmath>
#include <numbers>

#include "reference/sampling.h"

namespace candela::reference {

using std::numbers::pi;

double ggx_d(double n_h, double alpha) {
  const double a2 = alpha * alpha, t = n_h * n_h * (a2 - 1) + 1;
  return a2 / (pi * t * t);
}

double smith_v(double n_l, double n_v, double alpha) {
  const double a2 = alpha * alpha;
  return 0.5 / (n_l * std::sqrt(n_v * n_v * (1 - a2) + a2) + n_v * std::sqrt(n_l * n_l * (1 - a2) + a2));
}

double smith_g1(double n_v, double alpha) {
  const double a2 = alpha * alpha;
  return 2 * n_v / (n_v + std::sqrt(a2 + (1 - a2) * n_v * n_v));
}

double ggx_d(const StretchedFacets& f, glm::dvec3 h) {
  const double x = glm::dot(f.x, h) / f.alpha.x, y = glm::dot(f.y, h) / f.alpha.y, z = glm::dot(f.z, h);
  const double sum = x * x + y * y + z * z;
  return 1 / (pi * f.alpha.x * f.alpha.y * sum * sum);
}

double smith_v(const StretchedFacets& f, glm::dvec3 l, double n_l, glm::dvec3 v, double n_v) {
  const glm::dvec3 of_l(f.alpha.x * glm::dot(f.x, l), f.alpha.y * glm::dot(f.y, l), n_l),
      of_v(f.alpha.x * glm::dot(f.x, v), f.alpha.y * glm::dot(f.y, v), n_v);
  return 0.5 / (n_l * glm::length(of_v) + n_v * glm::length(of_l));
}

double smith_g1(const StretchedFacets& f, glm::dvec3 v) {
  const double n_v = glm::dot(f.z, v);
  const glm::dvec3 of_v(f.alpha.x * glm::dot(f.x, v), f.alpha.y * glm::dot(f.y, v), n_v);
  return 2 * n_v / (n_v + glm::length(of_v));
}

glm::dvec3 visible_normal(glm::dvec3 normal, glm::dvec3 v, double alpha, glm::dvec2 u) {
  StretchedFacets f{{}, {}, normal, glm::dvec2(alpha)};
  make_frame(normal, f.x, f.y);
  return visible_normal(f, v, u);
}

glm::dvec3 visible_normal(const StretchedFacets& f, glm::dvec3 v, glm::dvec2 u) {
  // Stretched so that the surface is a hemisphere of which v sees a half disc and a half ellipse.
  const glm::dvec3 stretched =
      glm::normalize(glm::dvec3(f.alpha.x * glm::dot(v, f.x), f.alpha.y * glm::dot(v, f.y), glm::dot(v, f.z)));
  const double across2 = stretched.x * stretched.x + stretched.y * stretched.y;
  const glm::dvec3 t1 =
      across2 > 0 ? glm::dvec3(-stretched.y, stretched.x, 0) / std::sqrt(across2) : glm::dvec3(1, 0, 0);
  const glm::dvec3 t2 = glm::cross(stretched, t1);
  const double r = std::sqrt(u.x), phi = 2 * pi * u.y, p1 = r * std::cos(phi), fraction = 0.5 * (1 + stretched.z);
  const double p2 = (1 - fraction) * std::sqrt(std::max(1 - p1 * p1, 0.0)) + fraction * r * std::sin(phi);
  const glm::dvec3 on_sphere = p1 * t1 + p2 * t2 + std::sqrt(std::max(1 - p1 * p1 - p2 * p2, 0.0)) * stretched;
  const glm::dvec3 m =
      glm::normalize(glm::dvec3(f.alpha.x * on_sphere.x, f.alpha.y * on_sphere.y, std::max(on_sphere.z, 0.0)));
  return m.x * f.x + m.y * f.y + m.z * f.z;
}

}  // namespace candela::reference
