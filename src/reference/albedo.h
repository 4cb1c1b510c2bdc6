#pragma once

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

}  // namespace candela::reference
