#pragma once
#include <algorithm>
#include <cmath>

#include "scene/scene.h"

// Exponents of Blinn's lobe, and the perceptual roughness of facets as wide: alpha^2 = 2 / (exponent + 2), alpha being
// roughness squared (Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007).
namespace candela {

inline constexpr double most_exponent = 1e6;

inline double exponent_of_roughness(double roughness) {
  const double alpha = roughness * roughness;
  return std::max(2 / std::max(alpha * alpha, 2 / (most_exponent + 2)) - 2, 0.0);
}
inline double roughness_of_exponent(double exponent) { return std::pow(2 / (exponent + 2), 0.25); }

// Before the material's textures.
inline double stated_roughness(const Material& m) {
  return m.blinn_phong.stated ? roughness_of_exponent(double(m.blinn_phong.exponent)) : double(m.roughness);
}

}  // namespace candela
