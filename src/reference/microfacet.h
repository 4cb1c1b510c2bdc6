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

// The same of facets that are rougher along one axis than along the other: unit axes at right angles, and a width each
// (Heitz 2014, 5.4). z: the shading normal.
struct StretchedFacets {
  glm::dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  glm::dvec2 alpha{1};
};
double ggx_d(const StretchedFacets& f, glm::dvec3 h);
// n_l, n_v: the cosines to be taken for those of l and v.
double smith_v(const StretchedFacets& f, glm::dvec3 l, double n_l, glm::dvec3 v, double n_v);
double smith_g1(const StretchedFacets& f, glm::dvec3 v);
glm::dvec3 visible_normal(const StretchedFacets& f, glm::dvec3 v, glm::dvec2 u);

}  // namespace candela::reference
