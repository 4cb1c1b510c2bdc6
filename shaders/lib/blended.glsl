#pragma once
// What a shaded surface puts out: premultiplied, pre-exposed radiance; or, of a blended one, its part of what a method
// of transparency sums (passes/transparency). Needs lib/frame.glsl.
#ifndef STORED
bool is_put_out() { return true; }
#endif
float view_depth(vec3 relative_position) { return -dot(relative_position, frame.camera_back); }

#ifdef WEIGHTED
#include "lib/absorbance.glsl"
layout(location = 0) out vec4 out_sum;
layout(location = 1) out float out_absorbed;

// McGuire and Bavoil 2013, equation 9, over its largest value. Radiance is held where a sum of many stays a float.
void put_out(vec4 premultiplied, vec3 relative_position) {
  const float far = view_depth(relative_position) / 200.0;
  const float w = premultiplied.a * clamp(0.03 / (1e-5 + far * far * far * far), 1e-2, 3e3) / 3e3;
  out_sum = vec4(min(premultiplied.rgb, vec3(1e30)), premultiplied.a) * w;
  out_absorbed = absorbance_of(premultiplied.a);
}
#elif defined(MOMENTS)
#include "lib/bindless.glsl"
#include "lib/moments.glsl"
layout(location = 0) out vec4 out_sum;

// An image of moments, where several samples of the pixel are covered the mean of theirs.
vec4 fetch_moments(uint place) {
  const ivec2 p = ivec2(gl_FragCoord.xy);
  const uint image = (pc.own >> (8u * place)) & 0xffu;
#ifdef MULTISAMPLED
  vec4 sum = vec4(0.0);
  const uint covered = uint(gl_SampleMaskIn[0]);
  for (uint s = 0u; s < 8u; ++s)
    if ((covered >> s & 1u) != 0u) sum += texelFetch(pass_multisampled_images[image], p, int(s));
  return sum / max(float(bitCount(covered)), 1.0);
#else
  return texelFetch(pass_images[image], p, 0);
#endif
}

// Dimmed by what lies before it.
void put_out(vec4 premultiplied, vec3 relative_position) {
  const vec4 first = fetch_moments(0u), absorbance = fetch_moments(1u);
  float transmitted = 1.0;
  if (absorbance.x > 0.0) {
#if MOMENTS == 4
    const vec4 m = first / absorbance.x;
#else
    float m[MOMENTS + 1];
    for (int k = 0; k < 4; ++k) m[k + 1] = first[k] / absorbance.x;
    m[5] = absorbance.y / absorbance.x;
    m[6] = absorbance.z / absorbance.x;
#endif
#if MOMENTS == 8
    m[7] = absorbance.w / absorbance.x;
    m[8] = fetch_moments(2u).x / absorbance.x;
#endif
    // What hides all before it is held above 0: the mean of what is hidden is one too.
    transmitted = exp(-min(absorbance.x * absorbed_before(m, warped_depth(relative_position)), 60.0));
  }
  out_sum = vec4(min(premultiplied.rgb, vec3(1e30)), premultiplied.a) * transmitted;
}
#elif defined(SUMMED)
#include "lib/absorbance.glsl"
#include "lib/warped_depth.glsl"
// SUMMED: the power of two by which the farthest surface counts less than the nearest.
layout(location = 0) out vec4 out_sum;
layout(location = 1) out vec4 out_absorbed;  // by colour; and of what the surface's own light lies over
#if defined(GLASS) || defined(BESIDE_GLASS)
layout(location = 2) out vec4 out_widths;
layout(location = 3) out vec4 out_moved;
#endif

void put_sums(vec3 light, vec3 hidden, float covered, vec3 relative_position) {
#if defined(GLASS) || defined(BESIDE_GLASS)
  out_widths = out_moved = vec4(0.0);
#endif
  const float w = exp2(-0.5 * float(SUMMED) * (1.0 + warped_depth(relative_position)));
  out_sum = vec4(min(light, vec3(1e30)), covered) * w;
  out_absorbed =
      vec4(absorbance_of(hidden.r), absorbance_of(hidden.g), absorbance_of(hidden.b), absorbance_of(covered));
}
void put_out(vec4 premultiplied, vec3 relative_position) {
  put_sums(premultiplied.rgb, vec3(premultiplied.a), premultiplied.a, relative_position);
}
#ifdef GLASS
#include "lib/glass_sums.glsl"

// What hides nothing, but shines, lies over a little of the picture.
void put_glass(vec3 light, GlassSums g, vec3 relative_position) {
  const vec3 hidden = clamp(1.0 - g.tint, vec3(0.0), vec3(1.0));
  const float covered = max((hidden.r + hidden.g + hidden.b) / 3.0, 1e-6);
  put_sums(light * g.covers, hidden * g.covers, covered * g.covers, relative_position);
  out_widths = g.widths * g.covers;
  out_moved = g.moved * g.covers;
}
#endif
#elif defined(STORED)
#include "lib/stored_fragments.glsl"
#else
layout(location = 0) out vec4 out_radiance;

void put_out(vec4 premultiplied, vec3 relative_position) { out_radiance = premultiplied; }
#endif
