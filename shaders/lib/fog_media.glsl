#pragma once
// Several media, whose sum the air is. Part of lib/fog_medium.glsl, with FOG_MEDIA.

// Beyond this optical depth sums of a few are still numbers, and so are their products with what is left.
const float FOG_MOST_DEPTH = 1e18;

// The part of a span that lies inside a medium's bounds; (0, 0) where none does.
vec2 fog_inside_of(int medium, vec3 origin, vec3 direction, vec2 span) {
  if (frame.fog.media[medium].bounded == 0u) return span;
  const vec2 turn = frame.fog.media[medium].turn, middle = frame.fog.media[medium].middle;
  origin.xz -= middle;
  origin.xz = vec2(turn.x * origin.x - turn.y * origin.z, turn.y * origin.x + turn.x * origin.z) + middle;
  direction.xz = vec2(turn.x * direction.x - turn.y * direction.z, turn.y * direction.x + turn.x * direction.z);
  return fog_inside_box(frame.fog.media[medium].lowest, frame.fog.media[medium].highest, origin, direction, span);
}

// Optical depth of one medium over a span; as fog_length of one medium alone, times its extinction.
vec3 fog_length_of(int medium, vec3 origin, vec3 direction, float begin_m, float end_m) {
  const vec2 span = fog_inside_of(medium, origin, direction, vec2(begin_m, end_m));
  if (!(span.y > span.x)) return vec3(0.0);
  const float metres = fog_dense_metres(frame.fog.media[medium].falloff, frame.fog.media[medium].height, origin,
      direction, span.x, span.y);
  return min(frame.fog.media[medium].extinction * metres, vec3(FOG_MOST_DEPTH));
}

// From where to where there is any of them in a span that takes light.
vec2 fog_inside(vec3 origin, vec3 direction, vec2 span) {
  vec2 all = vec2(0.0);
  for (int i = 0; i < FOG_MEDIA; ++i) {
    if (frame.fog.media[i].extinction == vec3(0.0)) continue;
    const vec2 one = fog_inside_of(i, origin, direction, span);
    if (one.y > one.x) all = all.y > all.x ? vec2(min(all.x, one.x), max(all.y, one.y)) : one;
  }
  return all;
}

vec3 fog_length(vec3 origin, vec3 direction, float begin_m, float end_m) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < FOG_MEDIA; ++i) sum += fog_length_of(i, origin, direction, begin_m, end_m);
  return sum;
}

vec3 fog_through(vec3 depth) { return exp(-min(depth, vec3(FOG_OPAQUE))); }
