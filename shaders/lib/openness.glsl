#pragma once
// How open a point is to the sky.
struct Openness {
  float fraction;  // of the light that an even sky would give
  vec3 bent;    // mean open direction, a unit vector; only where OCCLUSION_IS_BENT
};
