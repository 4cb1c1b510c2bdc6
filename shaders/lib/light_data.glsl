#pragma once
// The words of a light (shared/scene.h, Light). Needs shared/scene.h.

// A 64-bit word of a light. llvmpipe gathers every word lane by lane, which is most of what a light costs there: so
// they are few, and read only once the light may still give something.
vec2 light_word(LightRef light, uint word) { return uintBitsToFloat(unpackUint2x32(light.w[word])); }

LightRef light_at(uint64_t lights, uint index) { return LightRef(lights + 64ul * index); }

vec3 light_intensity(LightRef light) { return vec3(light_word(light, 5u), light_word(light, 6u).x); }
