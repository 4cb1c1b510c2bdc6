#pragma once
#include <optional>

#include "reference/brdf.h"

// Surfaces that let light through: KHR_materials_transmission with _volume, _ior, _specular and _dispersion, in double.
// Opaque surfaces are passed on to brdf.h, so that paths need not ask which they have.
//
// The dielectric interface has the exact Fresnel reflectance, scaled to the specular extension's values at normal and
// grazing incidence, over GGX facets (Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007).
// What it lets through meets the base: the transmitted fraction goes on, tinted by the base colour, the rest is
// diffuse. Below least_roughness the interface is a mirror and a window. Lobes (lobes.h) lie on it as on opaque
// surfaces; of what is left to the base after transmission, diffuse transmission takes its fraction.
namespace candela::reference {

// What a body scatters (KHR_materials_volume_scatter), 1/m: a part of its extinction, by Henyey and Greenstein's phase
// function.
struct BodyMedium {
  glm::dvec3 extinction{0}, scattering{0};
  double anisotropy = 0;
};

// Of a material.
struct Glass {
  double ior = 1.5;       // 0: reflects all, whatever the angle, and does not bend what specular still lets through
  double dispersion = 0;  // 20 over the Abbe number
  bool body = false;      // the surface bounds a body; else it is a sheet: light leaves in the direction it came
  glm::dvec3 attenuation_color{1};
  double attenuation_distance_m = 0;   // white has attenuation_color after this way, may be infinite
  std::optional<BodyMedium> medium{};  // nothing: the body only absorbs
};
// The index of refraction of red, green or blue light, of none of them (-1) the nominal one.
double index_of_refraction(const Glass& glass, int channel);

// Reflectance of a smooth dielectric for unpolarised light; eta: index behind over index before. 1 where all is
// reflected.
double fresnel(double cosine, double eta);

// Light goes straight through, as the surface says: a smooth sheet, or a body of the index of what is about it.
bool is_straight(const Surface& s);
// The fraction of it, seen from v.
glm::dvec3 straight_share(const Surface& s, glm::dvec3 v);

// What becomes of a ray at a smooth surface that bounds a body: it goes on behind it, or where no light gets there, is
// reflected. weight: all that goes that way, for radiance. Nothing where the surface scatters light.
struct Bend {
  glm::dvec3 l{0}, weight{0};
  glm::dvec3 facet{0};  // unit, on the side of v: the normal at which the ray turns
  bool through = false;
};
std::optional<Bend> bent(const Surface& s, glm::dvec3 v);

// f(l, v) |n.l|, 1/sr, of all lobes that have a density. For radiance: what comes from a medium of another index is
// scaled by the square of their ratio. punctual: mirrors show the light as a surface of least_roughness does, for
// nothing else can.
glm::dvec3 evaluate_bsdf(const Surface& s, glm::dvec3 l, glm::dvec3 v, bool punctual = false);
double bsdf_pdf(const Surface& s, glm::dvec3 l, glm::dvec3 v);  // 1/sr
// Of evaluate_bsdf()'s light, the fraction that the base reflects diffusely, channel by channel.
glm::dvec3 diffuse_share(const Surface& s, glm::dvec3 l, glm::dvec3 v);

// Whether light in direction l, counted away from the surface, is on the same side of the triangle as of the shading
// normal, and that side is open to light.
bool is_open(const Surface& s, glm::dvec3 l);

struct BsdfSample {
  glm::dvec3 l{0};
  glm::dvec3 weight{0};   // f |n.l| / density
  double pdf = 0;         // of the whole mixture, 1/sr; 0: of a lobe without density, which no other strategy meets
  bool through = false;   // to the other side
  bool straight = false;  // there, in the very direction: the ray goes on
};
// Nothing: the path ends.
std::optional<BsdfSample> sample_bsdf(const Surface& s, glm::dvec3 v, double lobe, glm::dvec2 u);

}  // namespace candela::reference
