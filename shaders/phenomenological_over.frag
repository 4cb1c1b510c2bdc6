#version 460
// What is behind a sample's see-through surfaces, moved, blurred and tinted by them, and their own light over it.
#include "shared/transparency.h"
layout(push_constant, scalar) uniform Push { PhenomenologicalPush pc; };
#include "lib/absorbance.glsl"
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

// A ray's search for where it meets the picture, by what its points are polynomials of: the farthest that lies before
// what is seen there, and the nearest behind.
struct Search {
  float q, before, behind;
};
Search begin_search(float q, float glass_m) { return Search(q, nearness(glass_m), -1.0); }
bool is_nearer(float a, float b) { return frame.perspective != 0u ? a > b : a < b; }
// there_m: the depth that is seen at the ray's point. False: that is before the glass.
bool go_on(inout Search s, float there_m, float glass_m) {
  const bool is_behind_glass = there_m >= glass_m * 0.9999;
  const float q = nearness(there_m);
  if (is_nearer(q, s.q) || !is_behind_glass) s.behind = s.q;
  else s.before = s.q;
  const bool within = is_behind_glass && is_nearer(s.before, q) && (s.behind < 0.0 || is_nearer(q, s.behind));
  s.q = within || s.behind < 0.0 || q == s.q ? q : 0.5 * (s.before + s.behind);
  return is_behind_glass;
}

vec4 seen_behind(vec4 widths, vec4 moved) {
  const float glass_m = widths.y / widths.x, dispersion = widths.w / widths.x;
  vec2 place = gl_FragCoord.xy;
  Search search = begin_search(nearness(refraction_depth_m(ivec2(place))), glass_m);
  float q = search.q;
  for (int i = 0; i < SEARCH; ++i) {
    const vec2 there = place_px(moved.xy + moved.zw * search.q);
    if (!go_on(search, refraction_depth_m(ivec2(floor(there))), glass_m)) continue;
    place = there;
    q = search.q;
  }
  const vec2 unit_px = 0.5 * vec2(frame.size_px) / frame.tan_half;
  const float width2 = width_squared(widths, q), width_px = sqrt(width2) * unit_px.x;
  if (TAPS <= 1 || width_px < 0.25)
    return picture_at(place, gl_FragCoord.xy, dispersion, TAPS > 1 ? 0.0 : log2(max(2.0 * width_px, 1.0)));
  // The lobe's shape in the picture is that of GGX's slopes. Each direction of it is followed to the depth that is seen
  // there, so that what touches the glass stays sharp and does not bleed.
  vec4 mean = vec4(0.0);  // so far: a sum of the brightest lies beyond floats
  int count = 0;
  for (int i = 0; i < TAPS; ++i) {
    const float u = (float(i) + 0.5) / float(TAPS), away2 = u / (1.0 - u);  // in squared widths
    const float turn = 2.399963230 * float(i);
    const float tilt2 = 0.25 * away2 * widths.x;  // squared tangent of a facet's tilt, of which light turns by twice
    if (!(tilt2 < 0.98)) continue;                // no light comes from before the glass
    const float stretched = 1.0 / (1.0 - tilt2);
    const vec2 away = sqrt(away2) * stretched * vec2(cos(turn), sin(turn));
    vec2 tap = place;
    float tap_px = 0.0;
    search = begin_search(q, glass_m);
    for (int k = 0; k < max(SEARCH, 1); ++k) {
      tap_px = sqrt(width_squared(widths, search.q)) * unit_px.x;
      const vec2 there = place + away * tap_px;
      if (go_on(search, refraction_depth_m(ivec2(floor(there))), glass_m)) tap = there;
    }
    // A square as large as the direction's fraction of the lobe.
    const float lod = log2(max(1.7724539 * tap_px / sqrt(float(TAPS)) * (1.0 + away2) * stretched, 1.0));
    mean = mix(mean, picture_at(tap, gl_FragCoord.xy + (tap - place), dispersion, lod), 1.0 / float(++count));
  }
  return count > 0 ? mean : picture_at(place, gl_FragCoord.xy, dispersion, log2(max(2.0 * width_px, 1.0)));
}
#endif

void main() {
  const vec4 sum = fetch_sample(pc.sum), absorbed = fetch_sample(pc.covered), left = exp(-absorbed);
  vec4 behind = fetch_sample(pc.color);
#ifdef REFRACTION
  const vec4 widths = fetch_sample(pc.widths);
  if (widths.x > 0.0) behind = seen_behind(widths, fetch_sample(pc.moved));
#endif
  cover_sample();
  const vec3 light = sum.a >= 1.2e-38 ? sum.rgb / sum.a * covered_by(absorbed.a) : vec3(0.0);
  out_radiance = vec4(behind.rgb * left.rgb + light, 1.0 - max(left.r, max(left.g, left.b)) * (1.0 - behind.a));
}
