#pragma once
#include <glm/glm.hpp>

#include "reference/microfacet.h"

// What surfaces reflect of a uniform sky, single scattering: integrals of the BRDF of brdf.h over the hemisphere.
namespace candela::reference {

// The specular lobe reflects f0 * scale + f90 * bias; of a diffuse lobe of albedo a there is left
// a * (1 - (f0 + (f90 - f0) * grazing)).
struct DirectionalAlbedo {
  double scale = 0, bias = 0, grazing = 0;
};

// By sampling visible normals on a grid: exact to 1e-3 with 48 an axis.
DirectionalAlbedo integrate_albedo(double roughness, double n_v, int per_axis);

// The same from a table, which the first call makes (0.2 s), by cubic interpolation: within 0.002 of the integral.
DirectionalAlbedo directional_albedo(double roughness, double n_v);

// What light that bounces on between facets makes of the specular lobe as seen from n_v: a white metal (f0 1) reflects
// all of a uniform sky, a coloured one is more saturated (Turquin, "Practical Multiple Scattering Compensation for
// Microfacet Models", 2019: 1 + f0 (1/E - 1)). Not reciprocal: the viewer's side alone is asked. For 1/E - 1 stands a
// fit of our own, which is part of the model: with it the white metal's furnace is within 0.006 of 1, at less than a
// degree from grazing 0.008.
glm::dvec3 specular_gain(glm::dvec3 f0, double roughness, double n_v);
// The same of stretched facets: the fit with v's cosine in the space where they are round, and for alpha that of round
// facets which lose as much light towards v, a fit of our own too. A white metal's furnace lies in 0.977 to 1.010, on
// average 0.998.
glm::dvec3 specular_gain(glm::dvec3 f0, const StretchedFacets& facets, glm::dvec3 v);
// Of round facets that stand for stretched ones seen from anywhere.
double mean_alpha(const StretchedFacets& facets);

}  // namespace candela::reference
