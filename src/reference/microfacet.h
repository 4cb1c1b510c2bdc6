#pragma once
#include <glm/glm.hpp>

// The GGX distribution of facets and Smith's masking, for reflection and for refraction. Angles are cosines to the
// shading normal; alpha is roughness squared.
namespace candela::reference {

double ggx_d(double n_h, double alpha);
// Height-correlated Smith over 4 (n.l) (n.v) (Heitz 2014); cosines are taken as positive.
double smith_v(double n_l, double n_v, double alpha);
// Smith masking of one direction.
double smith_g1(double n_v, double alpha);

// A facet's normal as it is seen from v, which lies above the surface: density G1 (v.h) D / (n.v) (Heitz, "Sampling the
// GGX Distribution of Visible Normals", 2018).
glm::dvec3 visible_normal(glm::dvec3 normal, glm::dvec3 v, double alpha, glm::dvec2 u);

}  // namespace candela::reference
