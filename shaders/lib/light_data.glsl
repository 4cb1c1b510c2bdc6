#pragma once
// The words of a light (shared/scene.h, Light). Needs shared/scene.h.

// What a point or spot light gives at most, in lux, however near it is: the same in every path, and at every scale of
// a scene whose intensities are scaled with its areas. It is held within a third of a micrometre of a candela.
const float MOST_LUX = 1e13;

// A 64-bit word of a light. llvmpipe gathers every word lane by lane, which is most of what a light costs there: so
// they are few, and read only once the light may still give something.
vec2 light_word(LightRef light, uint word) { return uintBitsToFloat(unpackUint2x32(light.w[word])); }

LightRef light_at(uint64_t lights, uint index) { return LightRef(lights + 64ul * index); }

float largest_channel(vec3 v) { return max(v.r, max(v.g, v.b)); }
// Nearer than this the inverse square of a light's intensity is held: its square.
float least_distance2(vec3 intensity) { return max(largest_channel(intensity) * (1.0 / MOST_LUX), 1e-30); }

vec3 light_intensity(LightRef light) { return vec3(light_word(light, 5u), light_word(light, 6u).x); }
