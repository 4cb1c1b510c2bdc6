#pragma once
// A texel of what see-through surfaces leave of a light at each distance (passes/transparency/deep_shadows.h), as it is
// drawn and as it is read.
#include "lib/absorbance.glsl"
#include "shared/shadows.h"

// What hides more is in the way of all light.
const float DEEP_SOLID = 254.5 / 255.0;
// Texels across that a range counts as deep at least: what is nearer to each other than that is not told apart.
const float DEEP_TEXELS = 2.0;

struct DeepRange {
  float nearest, width;  // of what hides a part; width 0: there is none
  float solid;           // distance of what hides all
  float least;           // width of DEEP_TEXELS
};

float deep_distance(float reversed_depth, bool parallel) {
  return parallel ? 1.0 - reversed_depth : lamp_near_m / reversed_depth;
}
DeepRange deep_range(vec4 stored, bool parallel) {
  DeepRange r;
  r.solid = stored.b > 0.0 ? deep_distance(stored.b, parallel) : 3e38;
  r.least = stored.a;
  r.nearest = r.width = 0.0;
  if (stored.r > 0.0) {
    r.nearest = deep_distance(stored.r, parallel);
    r.width = max(min(stored.g, r.solid) - r.nearest, r.least);
  }
  return r;
}
// Counted in slices, the first at 0. They are closer to each other near the light, where most of it is left: as a
// square root has it, but for the first hundredth, where that is too steep to tell a surface from itself.
float deep_place(DeepRange r, float distance, int slices) {
  const float x = (distance - r.nearest) / r.width, e = 0.01, root = sqrt(e), all = sqrt(1.0 + e) - root;
  return (x > 0.0 ? sqrt(x + e) - root : x / (2.0 * root)) / all * float(slices - 1);
}
// Of a surface at that place, what belongs to each of four slices.
vec4 deep_weights(float place, int first) {
  return max(1.0 - abs(vec4(float(first)) + vec4(0.0, 1.0, 2.0, 3.0) - place), vec4(0.0));
}
