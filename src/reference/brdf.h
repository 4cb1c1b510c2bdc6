#pragma once
#include <algorithm>
#include <glm/glm.hpp>
#include <optional>

#include "reference/lobes.h"

// The metallic-roughness BRDF of glTF 2.0, appendix B, in double, written from the specification and
// not from the shaders: an error in either shows as a difference. Beyond the specification it keeps the light that
// bounces more than once between facets: Surface::specular_gain. Surfaces with lobes of other extensions are passed on
// to lobes.h.
namespace candela::reference {

// Perceptual roughness below this counts as this, in every path: 32-bit floats overflow otherwise.
// Thus no lobe is a mirror, and every lobe has a density.
inline constexpr double least_roughness = 0.045;

struct Glass;    // bsdf.h
class Interior;  // interior.h

struct Surface {
  glm::dvec3 position{0};   // relative space, metres
  glm::dvec3 normal{0};     // unit, shading, on the viewer's side
  glm::dvec3 geometric{0};  // unit, of the triangle, on the viewer's side
  glm::dvec3 base_color{1};
  double metallic = 0, roughness = 1, occlusion = 1;
  glm::dvec3 emission{0};
  glm::dvec3 dielectric_f0{0.04};
  double dielectric_f90 = 1;
  glm::dvec3 specular_gain{1};  // of the opaque specular lobe, by light that bounces on between facets (albedo.h)
  double exponent = -1;         // of Blinn's lobe instead of facets (blinn_phong.h); below 0: facets
  double coverage = 1;          // 1 opaque, 0 a hole (glTF 3.9.4)
  bool unlit = false;           // base_color is what it shows
  std::optional<Lobes> lobes;   // beyond the base; nothing: there are none
  // Where light goes through (paths alone; the functions below know nothing of it).
  const Glass* glass = nullptr;  // null: opaque
  double transmission = 0;       // share of the base's light
  double eta = 1;                // index of refraction behind the surface over the one before it, on the viewer's side
  glm::dvec3 specular_tint{1};   // KHR_materials_specular: of the reflectance at normal incidence
  const Glass* body =
      nullptr;  // what lies behind, where the surface bounds a body, also one that only diffuse light enters
  const Interior *before = nullptr, *behind = nullptr;  // bodies about the point on either side; null: there are none
};

// Width of the specular lobe.
inline double alpha_of(const Surface& s) {
  const double r = std::max(s.roughness, least_roughness);
  return r * r;
}

// f(l, v) (n.l), 1/sr; 0 for light from below the shading normal, unless lobes take it. l and v are unit and point away
// from the surface.
glm::dvec3 evaluate_brdf(const Surface& s, glm::dvec3 l, glm::dvec3 v);
// The part of it that the base reflects diffusely.
glm::dvec3 diffuse_brdf(const Surface& s, glm::dvec3 l, glm::dvec3 v);

inline bool has_facets(const Surface& s) { return s.exponent < 0; }
// A direction in which the specular lobe of a surface without other lobes reflects v, and how densely these lie, 1/sr.
glm::dvec3 sample_base_lobe(const Surface& s, glm::dvec3 v, glm::dvec2 u);
double base_lobe_pdf(const Surface& s, glm::dvec3 l, glm::dvec3 v);

// Choosing a light direction by the BRDF: the cosine lobe, or visible GGX normals (Heitz, "Sampling the GGX
// Distribution of Visible Normals", 2018), with a probability by the lobes' estimated albedos. The density is of the
// whole mixture.
glm::dvec3 sample_brdf(const Surface& s, glm::dvec3 v, double lobe, glm::dvec2 u);
double brdf_pdf(const Surface& s, glm::dvec3 l, glm::dvec3 v);  // 1/sr

double luminance(glm::dvec3 rec709);
double largest(glm::dvec3 c);  // of its components

}  // namespace candela::reference
