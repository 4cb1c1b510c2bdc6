#pragma once
#include <glm/glm.hpp>
#include <optional>

#include "reference/albedo.h"
#include "reference/microfacet.h"

// What a Khronos material may have beyond the metallic-roughness base: KHR_materials_anisotropy, _iridescence, _sheen,
// _clearcoat and _diffuse_transmission, in double. Sheen lies on the base, the clear coat on top of both; each leaves a
// share of the light to what is under it.
namespace candela::reference {

struct Surface;  // brdf.h

// Of a point: factors times textures, within what their extensions allow. A factor of 0: there is no such lobe.
struct Lobes {
  double anisotropy = 0;      // strength
  glm::dvec3 along{1, 0, 0};  // unit, at right angles to the shading normal: facets are rougher along it
  double iridescence = 0;     // share of the surface that a film covers
  double film_ior = 1.3, film_nm = 400;
  glm::dvec3 sheen_color{0};
  double sheen_roughness = 0;
  double clearcoat = 0, clearcoat_roughness = 0;
  glm::dvec3 clearcoat_normal{0, 0, 1};  // unit, on the viewer's side
  double diffuse_transmission = 0;       // share of the diffuse light that comes out on the other side
  glm::dvec3 transmitted_color{1};
  // Where a body that scatters is taken for a slab: albedo of the diffuse lobe, for light from either side.
  struct Slab {
    glm::dvec3 front{0}, behind{0};
    double thickness_m = 0;  // so far behind the surface light from there comes in
  };
  std::optional<Slab> slab;
};

// Opaque surfaces that have lobes: what the functions of brdf.h are for them. Light may come from below the shading
// normal, to the coat's and through the surface.
glm::dvec3 evaluate_lobes(const Surface& s, glm::dvec3 l, glm::dvec3 v);
glm::dvec3 diffuse_lobes(const Surface& s, glm::dvec3 l, glm::dvec3 v);
glm::dvec3 sample_lobes(const Surface& s, glm::dvec3 v, double lobe, glm::dvec2 u);
double lobes_pdf(const Surface& s, glm::dvec3 l, glm::dvec3 v);
// The same of what is reflected specularly alone: coat, sheen and facets.
glm::dvec3 sample_specular(const Surface& s, glm::dvec3 v, glm::dvec2 u);
double specular_pdf(const Surface& s, glm::dvec3 l, glm::dvec3 v);

// Parts, for surfaces that let light through as well. The base: facets, stretched where the surface is anisotropic.
bool is_stretched(const Surface& s);
StretchedFacets facets_of(const Surface& s);
// What the facets reflect of a uniform sky; of stretched ones by the gain that they have.
DirectionalAlbedo facet_albedo(const Surface& s, glm::dvec3 v);
// A Fresnel reflectance, at the cosine to the facet, of a base of f0, as the film leaves it; no thickness is no film.
glm::dvec3 under_film(const Surface& s, glm::dvec3 reflectance, glm::dvec3 f0, double cosine);
bool transmits_diffusely(const Surface& s);
// Albedo of the diffuse lobe, for light from the viewer's side or from the other.
glm::dvec3 diffuse_color(const Surface& s, bool in_front);

// The layers on the base. What they leave of the light from l towards v to what is under them; the same of a uniform
// sky, and what the coat alone leaves, to sheen and emission.
double share_under(const Surface& s, glm::dvec3 l, glm::dvec3 v);
double share_under(const Surface& s, glm::dvec3 v);
double share_under_coat(const Lobes& lobes, glm::dvec3 v);
// f(l, v) times the cosine to the layer's own normal, 1/sr, of all that they reflect.
glm::dvec3 evaluate_layers(const Surface& s, glm::dvec3 l, glm::dvec3 v);
// What they reflect of a uniform sky.
glm::dvec3 sheen_reflectance(const Surface& s, glm::dvec3 v);
double coat_reflectance(const Surface& s, glm::dvec3 v);
// How often each is chosen, next to what is under them: a function of the viewer's direction alone.
struct LayerChoices {
  double coat = 0, sheen = 0, under = 1;
};
LayerChoices layer_choices(const Surface& s, glm::dvec3 v);
glm::dvec3 sample_coat(const Surface& s, glm::dvec3 v, glm::dvec2 u);
double layers_pdf(const Surface& s, const LayerChoices& choices, glm::dvec3 l, glm::dvec3 v);  // 1/sr, without `under`

}  // namespace candela::reference
