// KHR_lights_punctual. Needs lib/scene.glsl and lib/brdf.glsl.

#define LIGHT_EVAL
#include "lib/light_data.glsl"
#include "lib/unfused_dot.glsl"
#include "lib/axes.glsl"

// What of the light's intensity arrives at the position, per square metre perpendicular to its direction l. Exactly
// zero outside the range and the cone. Both ends are differences of nearly equal numbers; precise, so that all shaders
// round them alike.
float light_arriving(LightRef light, vec3 position, out vec3 l) {
  const vec2 xy = light_word(light, 0u), z_range = light_word(light, 1u);
  precise vec3 to_light = vec3(xy, z_range.x) - position;
  const float d2 = unfused_dot(to_light, to_light);
  l = vec3(0.0, 1.0, 0.0);
  precise float x2 = d2 * z_range.y * z_range.y;
  if (x2 >= 1.0) return 0.0;
  const vec2 z_type = light_word(light, 3u);
  const uint type = floatBitsToUint(z_type.y);
  if (type == light_directional) {
    l = -vec3(light_word(light, 2u), z_type.x);
    return 1.0;
  }
  if (!(d2 < 3.0e38)) return 0.0;  // farther than floats can say
  precise vec3 along = l;
  if (d2 > 0.0) along = to_light * inversesqrt(d2);
  l = along;
  precise float window = max(1.0 - x2 * x2, 0.0);
  if (type == light_stand_in) {  // less the window of its inner range, whose ones cancel
    const float inverse = light_word(light, 4u).x;
    precise float y2 = d2 * inverse * inverse;
    window = min(y2 * y2, 1.0) - x2 * x2;
  }
  precise float factor = window / max(d2, frame.least_light_distance2);
  if (type == light_spot) {
    const vec2 angle = light_word(light, 4u);
    precise vec3 e = along + vec3(light_word(light, 2u), z_type.x);
    precise float a = clamp(angle.y - unfused_dot(e, e) * angle.x, 0.0, 1.0);
    factor *= a * a;
  }
  return factor;
}

#ifdef LOBED
// Of the fragment's triangle, on the viewer's side, where shadows are asked for: what lies on the one side of it gets
// no light from the other but through the surface. Zero: not asked for.
vec3 lit_plane = vec3(0.0);
#endif

// From unit direction l; arriving: of its intensity, per square metre perpendicular to l.
vec3 light_along(LightRef light, BrdfTerms brdf, vec3 l, float arriving) {
#ifdef LOBED
  const LobesLit lit = evaluate_lobes(brdf, l);
  vec3 f = lit.front + lit.through;
  if (HAS_PASSING && lit_plane != vec3(0.0)) f = dot(lit_plane, l) < 0.0 ? lit.through : lit.front;
  return f == vec3(0.0) ? f : light_intensity(light) * arriving * f;
#else
  const float n_l = dot(brdf.normal, l);
  if (!(n_l > 0.0)) return vec3(0.0);
  return light_intensity(light) * (arriving * n_l) * evaluate_brdf(brdf, l, n_l);
#endif
}

#ifndef LOBED
// A smooth surface mirrors a sun's disc within less than a pixel where it is curved: its light over what the pixel
// mirrors (mirror_across, mirror_down), the disc and the lobe, each as a Gaussian of its variance. That of the pixel is
// half a pixel wide, so that the sum over pixels keeps all light (within 2 %).
void mirror_sun(LightRef light, BrdfTerms b, vec3 l) {
  mirrored_lobe = -1.0;
  const float roughness = sqrt(b.alpha), radius = light_word(light, 7u).x;
  if (!mirror_known || roughness >= smooth_roughness || !(radius > 0.0) || b.exponent >= 0.0 ||
      floatBitsToUint(light_word(light, 3u).y) != light_directional)
    return;
  mirrored_share = clamp(log2(smooth_roughness / roughness) / log2(smooth_roughness / least_roughness), 0.0, 1.0);
  const mat3 axes = axes_about(reflect(-b.to_viewer, b.normal));
  const vec3 off = l * axes;
  mirrored_lobe = 0.0;
  if (!(off.z > 0.0)) return;
  const vec2 a = (mirror_across * axes).xy, c = (mirror_down * axes).xy;
  const float own = 0.25 * radius * radius + 2.89 * b.alpha2;  // of the lobe half lies within 2 alpha
  const float xx = own + 0.25 * (a.x * a.x + c.x * c.x), yy = own + 0.25 * (a.y * a.y + c.y * c.y),
              xy = 0.25 * (a.x * a.y + c.x * c.y), det = max(xx * yy - xy * xy, own * own);
  const float distance2 = (yy * off.x * off.x - 2.0 * xy * off.x * off.y + xx * off.y * off.y) / det;
  mirrored_lobe = exp(-0.5 * distance2) / (2.0 * PI * sqrt(det));
}
#endif

vec3 light_contribution(LightRef light, BrdfTerms brdf, vec3 position) {
  vec3 l;
  const float arriving = light_arriving(light, position, l);
  // Also keeps an overflowing highlight from turning no light into 0 times infinity.
  if (arriving == 0.0) return vec3(0.0);
#ifndef LOBED
  if (MIRROR_TAPS != 0) {
    mirror_sun(light, brdf, l);
    const vec3 sum = light_along(light, brdf, l, arriving);
    mirrored_lobe = -1.0;
    return sum;
  }
#endif
  return light_along(light, brdf, l, arriving);
}
