// How open a fragment's surface is to the sky, from the texels of ambient occlusion about it. Needs
// lib/scene.glsl, lib/features.glsl and the push constant pc.occlusion. Only where HAS_OCCLUSION, which is the texels'
// shape, is not 0. Needs lib/traced_light.glsl.
#include "lib/occlusion_points.glsl"

// From camera space; the normal where nothing is open.
vec3 bent_in_world(vec3 bent, vec3 plane_normal) {
  if (!OCCLUSION_IS_BENT || !(dot(bent, bent) > 1e-12)) return plane_normal;
  return normalize(bent.x * frame.camera_right + bent.y * frame.camera_up + bent.z * frame.camera_back);
}

// How open bright spots are, by the mean and the mean square of texels: less their variance. On what is smaller than
// texels, most of what these disagree about is hidden, and a highlight that should not be there is seen more than one
// that lacks its rim.
float agreed_open(float mean, float square) { return clamp(mean - max(square - mean * mean, 0.0), 0.0, 1.0); }

// The four texels about the pixel, bilinear, each by how near its point lies to the fragment's plane: a floor at
// grazing angles still blends, and each fragment of an edge takes the texels of its own surface. Where none of them is
// of the surface, the texel of the 4 by 4 about it that is the most like it stands for all.
// Traced: of the point that begin_rays was called for.
Openness occlusion_open(vec3 relative, vec3 plane_normal) {
  if (HAS_OCCLUSION < 0) return traced_open();
  const vec3 p =
      vec3(dot(relative, frame.camera_right), dot(relative, frame.camera_up), dot(relative, frame.camera_back));
  const vec3 n = vec3(dot(plane_normal, frame.camera_right), dot(plane_normal, frame.camera_up),
      dot(plane_normal, frame.camera_back));
  const vec2 subsample_ndc = IS_SUBSAMPLE != 0 ? pc.subsample_ndc : vec2(0.0);
  const ivec2 last = textureSize(pass_images[pc.occlusion], 0) - 1;
  // A texel's point is of its first pixel.
  const vec2 at = (PIXEL_MIDDLE - 0.5) / float(max(OCCLUSION_TEXEL_PX(HAS_OCCLUSION), 1));
  const ivec2 corner = ivec2(floor(at));
  const vec2 f = at - vec2(corner);
  const bool by_rays = OCCLUSION_BY_RAYS(HAS_OCCLUSION) != 0;
  float sum = 0.0, weights = 0.0;
  float mirror = 0.0, lights = 0.0, lights2 = 0.0;
  vec2 bright = vec2(0.0);  // of all the sky, and of what is open
  vec3 bent = vec3(0.0);
  for (int i = 0; i < 4; ++i) {
    const ivec2 o = ivec2(i & 1, i >> 1), texel = clamp(corner + o, ivec2(0), last);
    const vec4 tap = texelFetch(pass_images[pc.occlusion], texel, 0);
    if (!(tap.y > 0.0)) continue;
    const vec2 b = mix(1.0 - f, f, vec2(o));
    const float w = b.x * b.y * occlusion_likeness(occlusion_point(texel, tap.y, HAS_OCCLUSION, subsample_ndc), p, n);
    if (!(w > 0.0)) continue;
    const vec2 both = by_rays ? unpack_open(tap.x) : vec2(tap.x, 0.0);
    sum += w * both.x;
    mirror += w * both.y;
    weights += w;
    if (OCCLUSION_IS_BENT) bent += w * tap.x * normal_at_place(tap.zw);
    if (!by_rays) continue;
    if (sky_has_lights()) {
      const vec2 of_lights = unpack_open(tap.w);
      bright += w * tap.z * vec2(1.0, of_lights.x);
      lights += w * of_lights.y;
      lights2 += w * of_lights.y * of_lights.y;
    } else {
      bright += w * tap.zw;
    }
  }
  if (weights > 1e-3) {
    const float fraction = sum == weights ? 1.0 : clamp(sum / weights, 0.0, 1.0);
    return Openness(fraction, by_rays ? open_diffuse(fraction, bright.x, bright.y) : fraction,
        by_rays ? clamp(mirror / weights, 0.0, 1.0) : -1.0, -1.0,
        by_rays && sky_has_lights() ? agreed_open(lights / weights, lights2 / weights) : -1.0,
        bent_in_world(bent, plane_normal));
  }
  lights = -1.0;
  float least = 3e38, open = by_rays ? pack_open(1.0, 1.0) : 1.0;
  for (int y = -1; y <= 2; ++y)
    for (int x = -1; x <= 2; ++x) {
      const ivec2 texel = clamp(corner + ivec2(x, y), ivec2(0), last);
      const vec4 tap = texelFetch(pass_images[pc.occlusion], texel, 0);
      if (!(tap.y > 0.0)) continue;
      const vec3 off = occlusion_point(texel, tap.y, HAS_OCCLUSION, subsample_ndc) - p;
      const float unlike = abs(dot(n, off)) + 0.1 * length(off);
      if (!(unlike < least)) continue;
      least = unlike;
      open = tap.x;
      if (OCCLUSION_IS_BENT) bent = normal_at_place(tap.zw);
      bright = tap.zw;
      if (!by_rays || !sky_has_lights()) continue;
      const vec2 of_lights = unpack_open(tap.w);
      bright.y = tap.z * of_lights.x;
      lights = of_lights.y;
    }
  const vec2 both = by_rays ? unpack_open(open) : vec2(clamp(open, 0.0, 1.0), -1.0);
  return Openness(both.x, by_rays ? open_diffuse(both.x, bright.x, bright.y) : both.x, both.y, -1.0, lights,
      bent_in_world(bent, plane_normal));
}
// Traced, also of the light that the surface reflects.
Openness occlusion_open(vec3 relative, vec3 plane_normal, Surface s, vec3 to_viewer) {
  Openness o = occlusion_open(relative, plane_normal);
  if (HAS_OCCLUSION < 0 && s.has_facets)
    o.lobe = traced_lobe(s.normal, to_viewer, s.roughness,
        dot(mix(s.dielectric_f0, s.base_color, s.metallic), vec3(0.2126, 0.7152, 0.0722)));
  return o;
}
