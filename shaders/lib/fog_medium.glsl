#pragma once
// Fog as a medium: its density falls exponentially with height and ends at bounds, so that what lies between two points
// of a ray has a closed form, in metres at density 1. Needs `frame`. Rays: unit directions, distances in metres.
//
// With FOG_MEDIA, several media (their number): fog_length is then the sum of their optical depths, channel by channel,
// and of any span, inside the bounds or not. Shaders of one medium compile none of it.

// As good as at infinity; its square is still a number.
const float FOG_FAR = 1e18;
// An exponent at which nothing is left; llvmpipe's exp of minus infinity is no number.
const float FOG_OPAQUE = 1e4;

// (1 - e^-x)/x and 1 - e^-x, right from 0 on: without the series all digits are gone at 1e-7.
float one_minus_exp_over(float x) {
  return x < 1e-2 ? 1.0 - x * (0.5 - x * (1.0 / 6.0)) : (1.0 - exp(-min(x, FOG_OPAQUE))) / x;
}
vec3 one_minus_exp_over(vec3 x) {
  return mix((1.0 - exp(-min(x, vec3(FOG_OPAQUE)))) / max(x, vec3(1e-30)), 1.0 - x * (0.5 - x * (1.0 / 6.0)),
      lessThan(x, vec3(1e-2)));
}
vec3 one_minus_exp(vec3 x) {
  return mix(1.0 - exp(-min(x, vec3(FOG_OPAQUE))), x * (1.0 - x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0)))),
      lessThan(x, vec3(1e-2)));
}

// The part of a span that lies inside a box; (0, 0) where none does.
vec2 fog_inside_box(vec3 lowest, vec3 highest, vec3 origin, vec3 direction, vec2 span) {
  for (int axis = 0; axis < 3; ++axis) {
    const float low = lowest[axis] - origin[axis], high = highest[axis] - origin[axis];
    if (direction[axis] == 0.0) {
      if (low > 0.0 || high < 0.0) return vec2(0.0);
      continue;
    }
    const float a = low / direction[axis], b = high / direction[axis];
    span = vec2(max(span.x, min(a, b)), min(span.y, max(a, b)));
  }
  return span.y > span.x ? span : vec2(0.0);
}

// Metres at density 1 of a span. Counted from the lower end up, where the density only falls: nothing overflows that
// does not have to, and what does lets nothing through in any case.
float fog_dense_metres(float falloff, float height, vec3 origin, vec3 direction, float begin_m, float end_m) {
  if (!(end_m > begin_m)) return 0.0;
  const float metres = end_m - begin_m;
  if (falloff == 0.0) return metres;
  const float rate = falloff * direction.y;
  const float lower = origin.y + direction.y * (rate > 0.0 ? begin_m : end_m);
  const float level = exp(min(falloff * (height - lower), 80.0));
  return min(level * metres * one_minus_exp_over(abs(rate) * metres), 3e38);
}

#ifdef FOG_MEDIA
#include "lib/fog_media.glsl"
#else
// The part of a span that lies inside the bounds; (0, 0) where none does.
vec2 fog_inside(vec3 origin, vec3 direction, vec2 span) {
  if (frame.fog.bounded == 0u) return span;
  return fog_inside_box(frame.fog.lowest, frame.fog.highest, origin, direction, span);
}

// Metres at density 1 of a span inside the bounds.
float fog_length(vec3 origin, vec3 direction, float begin_m, float end_m) {
  return fog_dense_metres(frame.fog.falloff, frame.fog.height, origin, direction, begin_m, end_m);
}

vec3 fog_through(float metres) { return exp(-min(frame.fog.extinction * metres, vec3(FOG_OPAQUE))); }

#endif

// What fog leaves of light over a distance in direction l; FOG_FAR: of light from the sky.
vec3 fog_through(vec3 from, vec3 l, float distance_m) {
#ifdef FOG_MEDIA
  return fog_through(fog_length(from, l, 0.0, distance_m));
#else
  const vec2 span = fog_inside(from, l, vec2(0.0, distance_m));
  return fog_through(fog_length(from, l, span.x, span.y));
#endif
}

#ifndef FOG_MEDIA
// Integral of the transmittance over metres of medium, (1 - e^(-extinction metres))/extinction: times scattering and
// light it stays right from extinction 0 to where it is the light over the extinction.
vec3 fog_held(float metres) {
  const vec3 x = frame.fog.extinction * metres;
  return mix((1.0 - exp(-min(x, vec3(FOG_OPAQUE)))) / frame.fog.extinction,
      metres * (1.0 - x * (0.5 - x * (1.0 / 6.0))),
      lessThan(x, vec3(1e-2)));
}

#endif

// Henyey and Greenstein ("Diffuse Radiation in the Galaxy", 1941), per steradian, of the cosine between the ways of
// light before and after. The base without cancellation, from the side where its terms have one sign.
float henyey_greenstein(float cosine, float g) {
  const float base = g < 0.0 ? (1.0 + g) * (1.0 + g) - 2.0 * g * (1.0 + cosine)
                             : (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cosine);
  return (1.0 - g * g) * (0.25 / 3.14159265358979) / (base * sqrt(base));
}

float henyey_greenstein(float cosine) { return henyey_greenstein(cosine, frame.fog.anisotropy); }

// The mean transmittance from a point to the sky, over a lobe about an axis: the cosine's, or that of the phase
// function with g. Places of a lattice, the same everywhere: no noise, and a knob says how many (fog.sky_directions).
vec3 fog_sky_through(vec3 from, vec3 axis, bool of_phase, float g) {
#ifndef FOG_MEDIA
  if (frame.fog.bounded == 0u && frame.fog.falloff == 0.0) return vec3(0.0);
#endif
  const vec3 away = abs(axis.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
  const vec3 x = normalize(cross(away, axis)), y = cross(axis, x);
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < frame.fog.sky_directions; ++i) {
    const float u = (float(i) + 0.5) / float(frame.fog.sky_directions);
    float cosine = sqrt(1.0 - u);
    if (of_phase) {
      const float s = 2.0 * u - 1.0, d = 1.0 + g * s;
      cosine = clamp((s + g * (s * s + 3.0) * 0.5 + g * g * s + g * g * g * (s * s - 1.0) * 0.5) / (d * d), -1.0, 1.0);
    }
    const float sine = sqrt(max(1.0 - cosine * cosine, 0.0)), turn = 6.28318530717959 * fract(0.618033989 * float(i));
    sum += fog_through(from, axis * cosine + (x * cos(turn) + y * sin(turn)) * sine, FOG_FAR);
  }
  return sum / float(frame.fog.sky_directions);
}

// Of the directions whose cosine to the vertical is mu, the mean of the cosine to a normal, below 0 as 0, times two:
// its integral over mu from 0 to 1 is the part of the cosine's lobe that points up. c: the normal's own cosine.
float fog_cosine_lobe(float mu, float c) {
  const float a = c * mu, b = sqrt(max((1.0 - c * c) * (1.0 - mu * mu), 0.0));
  if (b <= abs(a)) return 2.0 * max(a, 0.0);
  const float x = a / b, y = abs(x);
  // The arc's cosine within 7e-5 (Abramowitz and Stegun, 4.4.45).
  const float arc = sqrt(1.0 - y) * (1.5707288 + y * (-0.2121144 + y * (0.0742610 - 0.0187293 * y)));
  return (2.0 / 3.14159265358979) * (a * (x > 0.0 ? 3.14159265358979 - arc : arc) + sqrt(max(b * b - a * a, 0.0)));
}

// The mean transmittance from a point to the sky, by the cosine about a normal. Without bounds what lies towards the
// sky depends on height and elevation alone: two points of Gauss and Legendre for each 16 of fog.sky_directions.
vec3 fog_sky_through_surface(vec3 from, vec3 normal) {
#ifdef FOG_MEDIA
  return fog_sky_through(from, normal, false, 0.0);
#else
  if (frame.fog.bounded != 0u) return fog_sky_through(from, normal, false, 0.0);
  if (frame.fog.falloff == 0.0) return vec3(0.0);
  const uint panels = (frame.fog.sky_directions + 15u) / 16u;
  const float up = min(exp(min(frame.fog.falloff * (frame.fog.height - from.y), 80.0)) / frame.fog.falloff, 3e38);
  const float c = clamp(normal.y, -1.0, 1.0);
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < panels; ++i)
    for (int side = 0; side < 2; ++side) {
      const float mu = (float(i) + (side == 0 ? 0.21132487 : 0.78867513)) / float(panels);
      sum += fog_cosine_lobe(mu, c) * fog_through(min(up / mu, 3e38));
    }
  return sum * (0.5 / float(panels));
#endif
}
