#include "reference/brdf.h"

#include <cmath>
#include <numbers>

#include "reference/blinn_phong.h"
#include "reference/microfacet.h"
#include "reference/sampling.h"

namespace candela::reference {
namespace {

using std::numbers::pi;
constexpr double least_n_v = 1e-4;

// About what the specular lobe reflects, as scale of f0 and bias of f90: a fit (Karis, "Physically Based Shading on
// Mobile", 2014), whose bias is below 0 where surfaces are rough. Good enough to share out samples, for nothing else.
glm::dvec2 rough_albedo(double roughness, double n_v) {
  const glm::dvec4 r = roughness * glm::dvec4(-1, -0.0275, -0.572, 0.022) + glm::dvec4(1, 0.0425, 1.04, -0.04);
  const double a = std::min(r.x * r.x, std::exp2(-9.28 * n_v)) * r.x + r.y;
  return {-1.04 * a + r.z, 1.04 * a + r.w};
}

// Of the base beside a specular lobe without Fresnel term: what that reflects at its best the base does not get.
glm::dvec3 evaluate_blinn_phong(const Surface& s, double n_l, glm::dvec3 h) {
  const glm::dvec3 diffuse = s.base_color * ((1 - largest(s.dielectric_f0)) * (1 - s.metallic) / pi);
  const glm::dvec3 specular = glm::mix(s.dielectric_f0, s.base_color, s.metallic);
  return (diffuse + specular * blinn_phong(glm::dot(s.normal, h), s.exponent)) * n_l;
}

// How often the specular lobe is chosen; a function of what sampling and density both know.
double specular_share(const Surface& s, glm::dvec3 v) {
  const double n_v = glm::dot(s.normal, v);
  if (n_v <= least_n_v) return 0;  // visible normals are not defined from below
  if (!has_facets(s)) {
    const double specular = luminance(glm::mix(s.dielectric_f0, s.base_color, s.metallic)),
                 diffuse = luminance(s.base_color) * (1 - s.metallic) * (1 - largest(s.dielectric_f0));
    return specular > 0 ? std::clamp(specular / (specular + diffuse), 0.05, s.metallic < 1 ? 0.95 : 1.0) : 0;
  }
  const glm::dvec2 ab = rough_albedo(s.roughness, n_v);
  const glm::dvec3 dielectric = s.dielectric_f0 * ab.x + s.dielectric_f90 * ab.y, metal = s.base_color * ab.x + ab.y;
  const double specular = std::max(luminance(glm::mix(dielectric, metal, s.metallic)), 0.0);
  const double diffuse = luminance(s.base_color) * (1 - s.metallic) * std::max(1 - largest(dielectric), 0.0);
  if (!(specular > 0)) return 0;
  // Neither lobe is ever left out where it could matter.
  return std::clamp(specular / (specular + diffuse), 0.05, s.metallic < 1 ? 0.95 : 1.0);
}

}  // namespace

double largest(glm::dvec3 c) { return std::max({c.x, c.y, c.z}); }
double luminance(glm::dvec3 c) { return glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722)); }

glm::dvec3 evaluate_brdf(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  if (s.lobes) return evaluate_lobes(s, l, v);
  const double n_l = glm::dot(s.normal, l);
  if (!(n_l > 0)) return glm::dvec3(0);
  const double n_v = std::max(std::abs(glm::dot(s.normal, v)), least_n_v);
  const glm::dvec3 sum = l + v;
  const double length = glm::length(sum);
  const glm::dvec3 h = length > 1e-6 ? sum / length : s.normal;
  if (!has_facets(s)) return evaluate_blinn_phong(s, n_l, h);
  const double alpha = alpha_of(s);
  const glm::dvec3 specular = s.specular_gain * (ggx_d(glm::dot(s.normal, h), alpha) * smith_v(n_l, n_v, alpha));
  const double grazing = std::pow(std::clamp(1 - glm::dot(v, h), 0.0, 1.0), 5);
  const glm::dvec3 f_dielectric = s.dielectric_f0 + (s.dielectric_f90 - s.dielectric_f0) * grazing;
  const glm::dvec3 f_metal = s.base_color + (1.0 - s.base_color) * grazing;
  // Light that the specular layer of any channel takes does not reach the base (KHR_materials_specular: one number, so
  // that hue stays).
  const glm::dvec3 dielectric = s.base_color / pi * (1 - largest(f_dielectric)) + specular * f_dielectric;
  return glm::mix(dielectric, specular * f_metal, s.metallic) * n_l;
}

glm::dvec3 diffuse_brdf(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  if (s.lobes) return diffuse_lobes(s, l, v);
  const double n_l = glm::dot(s.normal, l);
  if (!(n_l > 0)) return glm::dvec3(0);
  const glm::dvec3 sum = l + v;
  const double length = glm::length(sum);
  const glm::dvec3 h = length > 1e-6 ? sum / length : s.normal;
  const double grazing = std::pow(std::clamp(1 - glm::dot(v, h), 0.0, 1.0), 5);
  const glm::dvec3 f_dielectric =
      has_facets(s) ? s.dielectric_f0 + (s.dielectric_f90 - s.dielectric_f0) * grazing : s.dielectric_f0;
  return s.base_color * ((1 - largest(f_dielectric)) * (1 - s.metallic) * n_l / pi);
}

glm::dvec3 sample_brdf(const Surface& s, glm::dvec3 v, double lobe, glm::dvec2 u) {
  if (s.lobes) return sample_lobes(s, v, lobe, u);
  if (lobe >= specular_share(s, v)) return cosine_direction(s.normal, u);
  return sample_base_lobe(s, v, u);
}

glm::dvec3 sample_base_lobe(const Surface& s, glm::dvec3 v, glm::dvec2 u) {
  const glm::dvec3 h =
      has_facets(s) ? visible_normal(s.normal, v, alpha_of(s), u) : blinn_half_vector(s.normal, s.exponent, u);
  return glm::normalize(2 * glm::dot(v, h) * h - v);
}

double base_lobe_pdf(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  const glm::dvec3 sum = l + v;
  const double length = glm::length(sum), n_v = glm::dot(s.normal, v);
  if (!(length > 1e-6) || !(n_v > 0)) return 0;
  const glm::dvec3 h = sum / length;
  const double n_h = glm::dot(s.normal, h);
  if (!(n_h > 0)) return 0;
  if (!has_facets(s)) return blinn_pdf(n_h, glm::dot(v, h), s.exponent);
  // D_v / (4 v.h), where D_v = G1 (v.h) D / (n.v).
  return smith_g1(n_v, alpha_of(s)) * ggx_d(n_h, alpha_of(s)) / (4 * n_v);
}

double brdf_pdf(const Surface& s, glm::dvec3 l, glm::dvec3 v) {
  if (s.lobes) return lobes_pdf(s, l, v);
  const double n_l = glm::dot(s.normal, l);
  if (!(n_l > 0)) return 0;
  const double fraction = specular_share(s, v);
  const double diffuse = (1 - fraction) * n_l / pi;
  return fraction > 0 ? diffuse + fraction * base_lobe_pdf(s, l, v) : diffuse;
}

}  // namespace candela::reference
