#pragma once
// How open a point is to the sky.
struct Openness {
  float fraction;  // of the light that an even sky would give
  float diffuse;   // of the diffuse light that this sky gives
  float mirror;    // of the mirror direction's light; below 0: not known
  float lobe;      // of the light that this surface reflects of this sky; below 0: not known
  float lights;    // of what a glossy surface reflects of the sky's bright spots; below 0: not known
  vec3 bent;       // mean open direction, a unit vector; only where OCCLUSION_IS_BENT
};
// Openness::diffuse, of means of how bright all the sky is and what is open of it; where it gives nothing, fraction.
float open_diffuse(float fraction, float bright, float bright_open) {
  if (!(bright > 0.0)) return fraction;
  return bright_open == bright ? 1.0 : clamp(bright_open / bright, 0.0, 1.0);  // a device may round x / x
}
// Two fractions in a number that floats hold exactly, twelve bits each: of the sky, and of the mirror direction.
const float OPENNESS_STEPS = 4095.0;
float pack_open(float fraction, float mirror) {
  return 4096.0 * floor(clamp(fraction, 0.0, 1.0) * OPENNESS_STEPS + 0.5) +
      floor(clamp(mirror, 0.0, 1.0) * OPENNESS_STEPS + 0.5);
}
vec2 unpack_open(float both) {
  const float high = floor(both * (1.0 / 4096.0));
  return vec2(high, both - 4096.0 * high) * (1.0 / OPENNESS_STEPS);
}
