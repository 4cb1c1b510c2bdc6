#pragma once
// How open a point is to the sky.
struct Openness {
  float fraction;  // of the light that an even sky would give
  float diffuse;   // of the diffuse light that this sky gives
  vec3 bent;       // mean open direction, a unit vector; only where OCCLUSION_IS_BENT
};
// Openness::diffuse, of means of how bright all the sky is and what is open of it; where it gives nothing, fraction.
float open_diffuse(float fraction, float bright, float bright_open) {
  if (!(bright > 0.0)) return fraction;
  return bright_open == bright ? 1.0 : clamp(bright_open / bright, 0.0, 1.0);  // a device may round x / x
}
