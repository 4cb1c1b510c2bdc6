#pragma once
#include <glm/glm.hpp>

// The lobe of Blinn, "Models of Light Reflection for Computer Synthesized Pictures", 1977, in double: a power of the
// cosine between normal and half vector, without a Fresnel term. Normalised by Giesen, "Phong and Blinn-Phong
// Normalization Factors", 2009: white reflects all of a uniform sky towards its normal, and less towards the sides.
// Reciprocal.
namespace candela::reference {

double blinn_phong(double n_h, double exponent);  // f of white, 1/sr
// The fraction of a uniform sky that white reflects towards n_v: summed over half vectors, exact to 1e-4 with 200 an
// axis; and from a table, within 0.001 of the sum.
double integrate_blinn_phong(double exponent, double n_v, int per_axis);
double blinn_phong_albedo(double exponent, double n_v);

// A half vector with density (exponent + 1) / (2 pi) (n.h)^exponent, and the density of the light directions mirrored
// at such, 1/sr.
glm::dvec3 blinn_half_vector(glm::dvec3 normal, double exponent, glm::dvec2 u);
double blinn_pdf(double n_h, double v_h, double exponent);

}  // namespace candela::reference
