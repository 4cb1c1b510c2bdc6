#pragma once
#include <glm/glm.hpp>

namespace candela::reference {

// What a thin film in air reflects, with the base under it: KHR_materials_iridescence, its approximation of Belcour and
// Barla, "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence" (2017), by Schlick's
// reflectance at both interfaces, two orders of interference and sensitivities of the eye in Fourier space; the path
// difference has the angle inside the film. Cut to [0, 1]: the sum of the model strays from it, by colours outside
// Rec. 709.
// cosine: of the angle in air; ior: of the film, from 1; f0: of the base in air at normal incidence, linear Rec. 709.
glm::dvec3 film_reflectance(double cosine, double ior, double thickness_nm, glm::dvec3 f0);

}  // namespace candela::reference
