#version 460
// What is behind a sample's see-through surfaces, moved, blurred and tinted by them, and their own light over it.
#include "shared/transparency.h"
layout(push_constant, scalar) uniform Push { PhenomenologicalPush pc; };
#include "lib/sample_over.glsl"
#ifdef REFRACTION
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
uint refraction_image(uint place) { return pc.images >> (8u * place) & 0xffu; }
#include "lib/seen_picture.glsl"
layout(constant_id = 43) const int TAPS = 16;
layout(constant_id = 44) const int SEARCH = 2;
#endif

layout(location = 0) out vec4 out_radiance;

#ifdef REFRACTION
vec2 place_px(vec2 moved) {
  const vec2 size = vec2(frame.size_px);
  const vec2 place = gl_FragCoord.xy + moved * (0.5 * size / frame.tan_half * vec2(1.0, -1.0));
  return clamp(place, -size, 2.0 * size);  // no number becomes one of these too
}
// What sums of glass (lib/glass_sums.glsl) are polynomials of.
float nearness(float depth_m) { return frame.perspective != 0u ? 1.0 / max(depth_m, 1e-20) : min(depth_m, 1e9); }
float width_squared(vec4 widths, float q) {
  const vec3 c = frame.perspective != 0u ? widths.xyz : widths.zyx;
  return max(c.x + q * (c.z * q - 2.0 * c.y), 1e-12 * c.x);
}
// The picture about a place as wide as 2^lod pixels; colours of their own places where glass disperses.
vec4 picture_at(vec2 place, vec2 undispersed, float dispersion, float lod) {
  vec4 seen = refraction_picture(place, lod);
  if (dispersion > 0.0) {
    const vec2 by = clamp((place - undispersed) * dispersion, -vec2(frame.size_px), vec2(frame.size_px));
    const vec4 red = refraction_picture(place - by, lod), blue = refraction_picture(place + by, lod);
    seen = vec4(red.r, seen.g, blue.b, max(seen.a, max(red.a, blue.a)));
  }
  return seen;
}

vec4 seen_behind(vec4 widths, vec4 moved) {
  const float glass_m = widths.y / widths.x, dispersion = widths.w / widths.x;
  vec2 place = gl_FragCoord.xy;
  float q = nearness(refraction_depth_m(ivec2(place)));
  for (int i = 0; i < SEARCH; ++i) {
    const vec2 there = place_px(moved.xy + moved.zw * q);
    const float there_m = refraction_depth_m(ivec2(floor(there)));
    if (there_m < glass_m * 0.9999) break;  // something before the glass
    place = there;
    q = nearness(there_m);
  }
  const vec2 unit_px = 0.5 * vec2(frame.size_px) / frame.tan_half;
  const float width2 = width_squared(widths, q), width_px = sqrt(width2) * unit_px.x;
  if (TAPS <= 1 || width_px < 0.25)
    return picture_at(place, gl_FragCoord.xy, dispersion, TAPS > 1 ? 0.0 : log2(max(2.0 * width_px, 1.0)));
  // The lobe's shape in the picture is that of GGX's slopes: taps by its shape here, each weighed by the shape that it
  // has at the tap's own depth, so that what touches the glass does not bleed.
  vec4 mean = vec4(0.0);
  float weights = 0.0;
  for (int i = 0; i < TAPS; ++i) {
    const float u = (float(i) + 0.5) / float(TAPS), away2 = u / (1.0 - u);  // in squared widths
    const float turn = 2.399963230 * float(i);
    const vec2 tap = place + sqrt(away2) * width_px * vec2(cos(turn), sin(turn));
    const float tap_m = refraction_depth_m(ivec2(floor(tap)));
    if (tap_m < glass_m * 0.9999) continue;
    const float ratio = width2 / max(width_squared(widths, nearness(tap_m)), 1e-6 * width2);
    const float shape = (1.0 + away2) / (1.0 + away2 * ratio);
    const float weight = ratio * shape * shape;
    const float lod = log2(max(1.7724539 * width_px / sqrt(float(TAPS)) * (1.0 + away2), 1.0));
    weights += weight;
    if (weight > 0.0) mean = mix(mean, picture_at(tap, gl_FragCoord.xy + (tap - place), dispersion, lod), weight / weights);
  }
  return weights > 0.0 ? mean : picture_at(place, gl_FragCoord.xy, dispersion, 0.0);
}
#endif

void main() {
  const vec4 sum = fetch_sample(pc.sum), covered = fetch_sample(pc.covered);
  vec4 behind = fetch_sample(pc.color);
#ifdef REFRACTION
  const vec4 widths = fetch_sample(pc.widths);
  if (widths.x > 0.0) behind = seen_behind(widths, fetch_sample(pc.moved));
#endif
  cover_sample();
  const vec3 left = 1.0 - covered.rgb;
  const vec3 light = sum.a >= 1.2e-38 ? sum.rgb / sum.a * covered.a : vec3(0.0);
  out_radiance = vec4(behind.rgb * left + light, 1.0 - max(left.r, max(left.g, left.b)) * (1.0 - behind.a));
}
