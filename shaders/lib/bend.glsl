#pragma once
// What a material says of the light that it lets through, and how light bends. Needs frame.lobes.
#include "shared/lobes.h"

Glass load_glass(uint material) {
  return MaterialLobesRef(frame.lobes + 4ul * uint64_t(WordsRef(frame.lobes).w[material])).m.glass;
}

// GLSL's refract() for the way of light towards the viewer run backwards; the direction itself where all is reflected.
vec3 bent(vec3 direction, vec3 normal, float eta) {
  const vec3 r = refract(direction, normal, eta);
  return dot(r, r) > 0.25 ? r : direction;
}
