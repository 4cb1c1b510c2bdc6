#pragma once
#include <glm/glm.hpp>

#include "reference/bsdf.h"
#include "scene/scene.h"

// Bodies that scatter light (KHR_materials_volume_scatter), in double. Paths walk through them (body_walk.cpp); direct
// light takes them for slabs of the file's thickness, as the techniques do.
namespace candela::reference {

// The fraction of its extinction that a medium scatters, of which a deep body reflects `multi` of diffuse light: the
// extension's fit (Kulla and Conty, "Revisiting Physically Based Shading at Imageworks", 2017), in [0, 1].
double single_scatter_albedo(double multi);

inline constexpr double most_extinction_per_m = 1e15;  // of attenuation colours of 0
BodyMedium body_medium(const Material& material);

// What a slab of the medium does to even light on one of its sides: two streams, with the reflected and absorbed
// fractions of Kubelka ("New Contributions to the Optics of Intensely Light-Scattering Materials", 1948) and, for
// those, 3/4 of the reduced scattering and twice the absorption.
struct SlabShares {
  glm::dvec3 reflected{0}, through{1};
};
SlabShares slab_shares(const BodyMedium& medium, double thickness_m);
// The same between two walls, each of which reflects and lets through these shares of what meets it, from either side.
SlabShares between_walls(const SlabShares& slab, const SlabShares& wall);

}  // namespace candela::reference
