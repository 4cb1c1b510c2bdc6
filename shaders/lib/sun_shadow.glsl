// How much of a directional light's rays come through, from its cascades of depth maps. Part of
// lib/light_shadow.glsl; needs pc.suns and pc.sun_maps. Only where HAS_SUN_SHADOWS is 1.
//
// A point takes the finest cascade that covers it, from there the mean of nine comparisons on a Poisson disc that is
// turned from pixel to pixel (noise instead of bands; Jimenez, "Next Generation Post Processing in Call of Duty:
// Advanced Warfare", 2014, for the turn). The disc's radius is 1.25 texels, and widens to 2.5 towards a cascade's edge,
// where the next one's texels are larger. The point is moved off its surface along the triangle's normal by as much as
// the slope can differ within the reach of the lookup (Holbert, "Saying Goodbye to Shadow Acne", 2011).
#include "lib/plane.glsl"
#include "lib/sun_cascades.glsl"

const float KERNEL_TEXELS = 1.25, WIDEST_KERNEL_TEXELS = 2.5;
const vec2 POISSON_DISC[9] = vec2[](vec2(-0.4862, 0.1613), vec2(0.5966, 0.2921), vec2(0.4500, -0.7884),
                                    vec2(-0.4681, -0.6912), vec2(-0.4098, 0.8839), vec2(0.1890, -0.1863),
                                    vec2(-0.9707, -0.2080), vec2(0.9302, -0.2334), vec2(0.1930, 0.7432));

// 1: lit, 0: in shadow. position: relative; normal: of the triangle.
float sun_visibility(uint sun, vec3 position, vec3 normal) {
  SunShadowsRef suns = SunShadowsRef(pc.suns);
  const float n_l = dot(normal, suns.s[sun].to_light);
  if (!(n_l > 0.0)) return 0.0;
  const CascadePlace place = find_cascade(sun, position);
  if (place.number == max_sun_cascades) return 1.0;
  const SunCascade cascade = place.cascade;
  const float radius = mix(KERNEL_TEXELS, WIDEST_KERNEL_TEXELS, clamp(2.0 * place.to_edge - 1.0, 0.0, 1.0));
  // The lookup reads texels up to radius + sqrt(2) away, whose depth on a plane differs by that times the tangent of
  // the angle; moving by d along the normal gains d divided by the cosine.
  const float sine = sqrt(max(1.0 - n_l * n_l, 0.0));
  const vec3 moved = position + normal * ((radius + 1.4142136) * cascade.texel_m * sine);
  const vec2 across = vec2(dot(suns.s[sun].right, moved), dot(suns.s[sun].up, moved)) - cascade.centre_m;
  const float depth = dot(suns.s[sun].depth, vec4(moved, 1.0)) + suns.s[sun].bias;
  const float per_metre = 0.5 / cascade.half_m;
  const vec2 uv = vec2(0.5) + vec2(across.x, -across.y) * per_metre;
  const float layer = float(suns.s[sun].first_layer + place.number);
  const float turn = shadow_turn();
  const vec2 cos_sin = vec2(cos(turn), sin(turn)) * (radius * cascade.texel_m * per_metre);
  float lit = 0.0;
  for (int i = 0; i < 9; ++i) {
    const vec2 p = POISSON_DISC[i];
    const vec2 at = uv + vec2(p.x * cos_sin.x - p.y * cos_sin.y, p.x * cos_sin.y + p.y * cos_sin.x);
    lit += textureGrad(
        sampler2DArrayShadow(pass_array_images[pc.sun_maps], graph_shadow_samplers[SAMPLER_SHADOW_LINEAR]),
        vec4(at, layer, depth), vec2(0.0), vec2(0.0));
  }
  return lit / 9.0;
}
