// How much of a directional light's rays come through, from its cascades of depth maps. Part of
// lib/light_shadow.glsl; needs pc.suns and pc.sun_maps. Only where HAS_SUN_SHADOWS is 1.
//
// A point takes the finest cascade that covers it, from there the mean of nine comparisons on a Poisson disc of 1.25
// texels, which widens to 2.5 towards a cascade's edge, where the next one's texels are larger. The disc is stretched
// by what the pixel covers of the surface, so that an edge finer than pixels is their mean and does not jump from one
// to the next as the camera moves. The point is moved off its surface along the triangle's normal by as much as the
// slope can differ within the reach of the disc (Holbert, "Saying Goodbye to Shadow Acne", 2011); along the pixel's
// part each comparison is with the plane of the triangle there (Isidoro, "Shadow Mapping: GPU-based Tips and
// Techniques", 2006).
#include "lib/plane.glsl"
#include "lib/sun_cascades.glsl"

const float KERNEL_TEXELS = 1.25, WIDEST_KERNEL_TEXELS = 2.5, MOST_KERNEL_TEXELS = 6.0;
// Within a pixel what stands on the plane is no blocker as far as it rises towards the light by no more than this, over
// the distance from the point across the light: or the foot of a wall would darken the floor before it.
const float PIXEL_CORNER_LIFT = 2.0;
const vec2 POISSON_DISC[9] = vec2[](vec2(-0.4862, 0.1613), vec2(0.5966, 0.2921), vec2(0.4500, -0.7884),
                                    vec2(-0.4681, -0.6912), vec2(-0.4098, 0.8839), vec2(0.1890, -0.1863),
                                    vec2(-0.9707, -0.2080), vec2(0.9302, -0.2334), vec2(0.1930, 0.7432));

// Number i of count places on a disc, evenly spread along a spiral (Vogel, "A better way to construct the sunflower
// head", 1979), turned.
vec2 shadow_place(uint i, uint count, float turn) {
  const float angle = 2.3999632 * float(i) + turn;
  return sqrt((float(i) + 0.5) / float(count)) * vec2(cos(angle), sin(angle));
}

// A step's part across the light, in metres along the axes of its maps.
vec2 across_light(uint sun, vec3 step) {
  SunShadowsRef suns = SunShadowsRef(pc.suns);
  return vec2(unfused_dot(suns.s[sun].right, step), unfused_dot(suns.s[sun].up, step));
}

// Of a sun with a size: what blocks it nearby is looked for over the disc of directions to it, and the mean distance of
// that tells how wide the shadow's edge is (Fernando, "Percentage-Closer Soft Shadows", 2005). Each lookup is compared
// with what the plane of the point's triangle has there (Isidoro 2006), or with the point's own depth where the plane
// leads away from the light. Leaves wrong: blockers at several distances, which are one; and what lies farther off than
// the disc of the search, no wider than a quarter of the map, tells.
float soft_sun_visibility(uint sun, vec3 position, vec3 normal, float n_l, CascadePlace place) {
  SunShadowsRef suns = SunShadowsRef(pc.suns);
  const uint count = max(RaySettingsRef(pc.rays).s.sun_samples, 1u);
  const vec4 depth_row = suns.s[sun].depth;
  const float per_metre = length(depth_row.xyz);  // of depth
  const float tangent = suns.s[sun].tangent;
  const float before_m = max(1.0 - dot(depth_row, vec4(position, 1.0)), 0.0) / per_metre;
  float search_m = 0.0;
  while (true) {  // in a map that holds the whole disc
    search_m = min(tangent * before_m, 0.25 * place.cascade.half_m);
    const bool fits = place.to_edge * place.cascade.covered_m + search_m <= place.cascade.covered_m;
    if (fits || place.number + 1u >= suns.s[sun].cascade_count) break;
    ++place.number;
    const vec2 aside = abs(vec2(dot(suns.s[sun].right, position), dot(suns.s[sun].up, position)) -
        suns.s[sun].cascades[place.number].centre_m);
    place.cascade = suns.s[sun].cascades[place.number];
    place.to_edge = max(aside.x, aside.y) / place.cascade.covered_m;
  }
  const float texel_m = place.cascade.texel_m, uv_per_metre = 0.5 / place.cascade.half_m;
  const float sine = sqrt(max(1.0 - n_l * n_l, 0.0));
  const vec3 moved = position + normal * ((KERNEL_TEXELS + 1.4142136) * texel_m * sine);
  const vec2 across = vec2(dot(suns.s[sun].right, moved), dot(suns.s[sun].up, moved)) - place.cascade.centre_m;
  const float depth = dot(depth_row, vec4(moved, 1.0)) + suns.s[sun].bias;
  const vec2 uv = vec2(0.5) + vec2(across.x, -across.y) * uv_per_metre;
  const float layer = float(suns.s[sun].first_layer + place.number);
  const float turn = shadow_turn();
  const PixelSpan span = pixel_span(position, normal);
  const vec2 slope = -vec2(dot(normal, suns.s[sun].right), dot(normal, suns.s[sun].up)) * (per_metre / n_l);
  search_m = max(search_m, KERNEL_TEXELS * texel_m);
  float blockers = 0.0, nearer = 0.0;
  for (uint i = 0u; i < count; ++i) {
    const vec2 off = search_m * shadow_place(i, count, turn);
    const float own = depth + max(dot(slope, off), 0.0);
    const float stored = textureLod(
        sampler2DArray(pass_array_images[pc.sun_maps], graph_samplers[SAMPLER_NEAREST_CLAMP]),
        vec3(uv + vec2(off.x, -off.y) * uv_per_metre, layer), 0.0).r;
    if (!(stored > own)) continue;
    blockers += 1.0;
    nearer += stored - own;
  }
  if (blockers == 0.0) return 1.0;
  const float radius_m = max(tangent * (nearer / (blockers * per_metre)), KERNEL_TEXELS * texel_m);
  const Ellipse reach = ellipse_of(min(radius_m, search_m), across_light(sun, span.across),
      across_light(sun, span.down), max(search_m, MOST_KERNEL_TEXELS * texel_m));
  float lit = 0.0;
  for (uint i = 0u; i < count; ++i) {
    const vec2 p = shadow_place(i, count, turn + 1.2), off = on_ellipse(reach, p);
    const float beyond_m = length(off - min(radius_m, search_m) * p);
    const float own = depth + max(dot(slope, off), 0.0) + beyond_m * PIXEL_CORNER_LIFT * per_metre;
    lit += textureGrad(
        sampler2DArrayShadow(pass_array_images[pc.sun_maps], graph_shadow_samplers[SAMPLER_SHADOW_LINEAR]),
        vec4(uv + vec2(off.x, -off.y) * uv_per_metre, layer, own), vec2(0.0), vec2(0.0));
  }
  return lit / float(count);
}

// 1: lit, 0: in shadow. position: relative; normal: of the triangle. Where it looks is precise: filters take places of
// texels in steps, so that a last bit would be one of them.
float sun_visibility(uint sun, vec3 position, vec3 normal) {
  SunShadowsRef suns = SunShadowsRef(pc.suns);
  const float n_l = unfused_dot(normal, suns.s[sun].to_light);
  if (!(n_l > 0.0)) return 0.0;
  const CascadePlace place = find_cascade(sun, position);
  if (place.number == max_sun_cascades) return 1.0;
  if (SUNS_SOFT && suns.s[sun].tangent > 0.0) return soft_sun_visibility(sun, position, normal, n_l, place);
  const SunCascade cascade = place.cascade;
  const float radius = mix(KERNEL_TEXELS, WIDEST_KERNEL_TEXELS, clamp(2.0 * place.to_edge - 1.0, 0.0, 1.0));
  // The lookup reads texels up to radius + sqrt(2) away, whose depth on a plane differs by that times the tangent of
  // the angle; moving by d along the normal gains d divided by the cosine.
  const float sine = sqrt(max(1.0 - n_l * n_l, 0.0));
  precise vec3 moved = position + normal * ((radius + 1.4142136) * cascade.texel_m * sine);
  precise vec2 across =
      vec2(unfused_dot(suns.s[sun].right, moved), unfused_dot(suns.s[sun].up, moved)) - cascade.centre_m;
  const vec4 depth_row = suns.s[sun].depth;
  precise float depth = unfused_dot(depth_row.xyz, moved) + depth_row.w + suns.s[sun].bias;
  const float per_metre = 0.5 / cascade.half_m;
  precise vec2 uv = vec2(0.5) + vec2(across.x, -across.y) * per_metre;
  const float layer = float(suns.s[sun].first_layer + place.number);
  // The disc becomes an ellipse with the variances of disc and pixel together.
  const PixelSpan span = pixel_span(position, normal);
  const Ellipse reach = ellipse_of(radius * cascade.texel_m, across_light(sun, span.across),
      across_light(sun, span.down), MOST_KERNEL_TEXELS * cascade.texel_m);
  precise vec2 slope = -vec2(unfused_dot(normal, suns.s[sun].right), unfused_dot(normal, suns.s[sun].up)) *
      (length(depth_row.xyz) / max(n_l, 0.05));
  const float corner_lift = PIXEL_CORNER_LIFT * length(depth_row.xyz);
  float lit = 0.0;
  for (int i = 0; i < 9; ++i) {
    const vec2 p = POISSON_DISC[i];
    const vec2 off = on_ellipse(reach, p);
    precise vec2 beyond = off - radius * cascade.texel_m * p;  // of the disc about the point itself
    precise float own = depth + max(slope.x * beyond.x + slope.y * beyond.y, 0.0) + length(beyond) * corner_lift;
    precise vec2 at = uv + vec2(off.x, -off.y) * per_metre;
    lit += textureGrad(
        sampler2DArrayShadow(pass_array_images[pc.sun_maps], graph_shadow_samplers[SAMPLER_SHADOW_LINEAR]),
        vec4(at, layer, own), vec2(0.0), vec2(0.0));
  }
  return lit / 9.0;
}
