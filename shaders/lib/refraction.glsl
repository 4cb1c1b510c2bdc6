#pragma once
// What is seen through a surface that lets light through, of the picture without such surfaces. Light goes into the
// surface by its index of refraction, through as much of the body as the file says is there, and leaves it as it came:
// a slab. A sheet bends nothing. Needs lib/surface.glsl, lib/brdf.glsl, lib/ambient.glsl, lib/image_kinds.glsl and the
// push constants pc.table and frame.lobes.
#include "shared/refraction.h"
#include "lib/axes.glsl"
#include "lib/glass.glsl"
#include "lib/visible_normal.glsl"
// Directions of the lobe that are followed to the depth that is seen there; 0: one look-up at the exit from the body,
// in the mip level that roughness and index choose (the rule of Khronos's sample renderer).
layout(constant_id = 40) const int REFRACTION_SAMPLES = 0;

struct Refracted {
  float fraction;  // of the diffuse base's light that goes through instead
  vec4 light;   // pre-exposed, behind the surface as the camera would see it; and what of the picture is covered
  vec3 tint;    // of it, what the surface lets through
  bool is_traced;  // by a ray, which begins behind the fog before the surface
};
// What of it comes to the camera through fog, which the picture has in it.
vec3 refracted_through(Refracted r, vec3 fog_light, vec3 fog_through) {
  if (r.is_traced) return r.light.rgb * fog_through;
  return r.tint * max(r.light.rgb - fog_light, vec3(0.0));
}

uint refraction_image(uint place) { return REFRACTION_PLACE(uint(pc.table), place); }

#include "lib/seen_picture.glsl"
#ifdef BODIES
#include "lib/glass_way.glsl"
#endif

// Pixels, from the point's own place; a direction's for points infinitely far (w 0).
vec2 refraction_place_px(vec3 position, float w) {
  const float depth = -dot(position, frame.camera_back);
  vec2 ndc = vec2(dot(position, frame.camera_right), -dot(position, frame.camera_up)) / frame.tan_half;
  if (frame.perspective != 0u)
    ndc /= max(depth, 1e-20);
  else if (w == 0.0)
    ndc = vec2(0.0);
  if (IS_SUBSAMPLE != 0) ndc -= pc.subsample_ndc;
  return clamp(ndc * 0.5 + 0.5, vec2(-1.0), vec2(2.0)) * vec2(frame.size_px);
}

// A surface whose alpha covers a part: through the rest the picture is seen as it is.
vec4 covering_picture(vec4 seen, float coverage) {
  return coverage < 1.0 ? mix(refraction_picture(gl_FragCoord.xy, 0.0), seen, coverage) : seen;
}

// One look-up.
vec4 seen_through_body(GlassPoint g) {
  const vec3 inside = bent(-g.to_viewer, g.normal, 1.0 / g.ior);
  const vec3 exit = g.position + inside * g.thickness_m;
  const vec2 moved = refraction_place_px(exit, 1.0) - refraction_place_px(g.position, 1.0);
  vec2 place = g.pixel + (g.thickness_m > 0.0 ? moved : vec2(0.0));
  if (refraction_depth_m(ivec2(floor(place))) < g.depth_m) place = g.pixel;  // something before the glass
  const float lod = log2(float(frame.size_px.x)) * g.roughness * clamp(g.ior * 2.0 - 2.0, 0.0, 1.0);
  return refraction_picture(place, lod);
}

// The lobe, by the normals that the viewer sees (Heitz, "Sampling the GGX Distribution of Visible Normals", 2018), each
// as wide as its fraction of it (Krivanek and Colbert 2008). The same directions at every pixel: no noise.
vec4 seen_through_lobe(GlassPoint g, int samples) {
  const mat3 axes = axes_about(g.normal);
  vec3 v = g.to_viewer * axes;
  v = normalize(vec3(v.xy, max(v.z, 1e-4)));
  const vec3 stretched = normalize(vec3(g.alpha * v.xy, v.z));
  const float across2 = dot(stretched.xy, stretched.xy), alpha2 = g.alpha * g.alpha;
  const vec3 t1 = across2 > 1e-12 ? vec3(-stretched.y, stretched.x, 0.0) * inversesqrt(across2) : vec3(1.0, 0.0, 0.0);
  const vec3 t2 = cross(stretched, t1);
  const float g1 = 2.0 * v.z / (v.z + sqrt(v.z * v.z * (1.0 - alpha2) + alpha2));
  const bool is_body = g.thickness_m > 0.0;
  const float at_viewer_px = refraction_depth_m(ivec2(g.pixel));
  vec4 mean = vec4(0.0);  // so far: a sum of the brightest lies beyond floats
  float weights = 0.0;
  for (int i = 0; i < samples; ++i) {
    const float u = (float(i) + 0.5) / float(samples);
    const float phi = 2.0 * PI * float(bitfieldReverse(uint(i))) * (1.0 / 4294967296.0);
    const vec2 disc = (samples == 1 ? 0.0 : sqrt(u)) * vec2(cos(phi), sin(phi));
    const vec3 h = samples == 1 ? vec3(0.0, 0.0, 1.0) : visible_normal(stretched, t1, t2, vec2(g.alpha), disc);
    const float v_h = dot(v, h);
    if (!(v_h > 0.0)) continue;
    vec3 l, from = g.position;
    float spread = 4.0 * v_h;  // solid angle of directions over that of normals
    if (is_body) {
      // In by the facet, out of the slab's other side.
      const vec3 inside = bent(-v, h, 1.0 / g.ior);
      from += axes * inside * g.thickness_m;
      l = bent(inside, vec3(0.0, 0.0, 1.0), g.ior);
      const float bend = g.ior - 1.0;
      spread = max(4.0 * v_h * bend * bend, 1e-4);
    } else {
      // Mirrored by the facet, and to the sheet's other side.
      l = 2.0 * v_h * h - v;
      l.z = -l.z;
    }
    if (!(l.z < 0.0)) continue;
    const float shadowed = 2.0 * -l.z / (-l.z + sqrt(l.z * l.z * (1.0 - alpha2) + alpha2));
    const vec3 direction = axes * l;
    // To the depth that is seen where the ray meets it: two steps of a search.
    const float forward = -dot(direction, frame.camera_back), from_m = -dot(from, frame.camera_back);
    float seen_m = at_viewer_px;
    vec2 place = g.pixel;
    float far_m = 3.0e38;
    for (int k = 0; k < 2; ++k) {
      const bool is_far = !(seen_m < 1e18) || !(forward > 1e-4);
      far_m = is_far ? 3.0e38 : max((seen_m - from_m) / forward, 0.0);
      // Off the straight way's place, which is the pixel's middle whatever floats say of it.
      place = is_far ? refraction_place_px(direction, 0.0) + (g.pixel - refraction_place_px(-g.to_viewer, 0.0))
                     : refraction_place_px(from + direction * far_m, 1.0) +
              (g.pixel - refraction_place_px(g.position, 1.0));
      const float there_m = refraction_depth_m(ivec2(floor(place)));
      if (there_m < g.depth_m) break;  // something before the glass
      seen_m = there_m;
    }
    float lod = 0.0;
    if (samples > 1) {
      const float k = dot(h.xy, h.xy) + h.z * h.z * alpha2;
      const float pdf = g1 * v_h * alpha2 / (PI * k * k * v.z) / spread;
      const float angle = sqrt(1.0 / (float(samples) * max(pdf, 1e-8)));  // of a square as large as its fraction
      const float pixel_angle = 2.0 * frame.tan_half.x / float(frame.size_px.x);
      // Seen from the camera, a place so far behind the glass is nearer than from the glass.
      const float nearer = far_m < 1e18 && frame.perspective != 0u ? far_m / max(seen_m, 1e-20) : 1.0;
      lod = log2(max(angle * nearer / pixel_angle, 1e-6));
    }
    weights += shadowed;
    if (shadowed > 0.0) mean = mix(mean, refraction_picture(place, lod), shadowed / weights);
  }
  return weights > 0.0 ? mean : refraction_picture(g.pixel, 0.0);
}

vec4 seen_through(GlassPoint g) {
  if (!(g.ior >= 1.0)) g.ior = 1.0;  // 0 is what bends nothing; below 1 is no glass in air
  if (REFRACTION_SAMPLES == 0) return seen_through_body(g);
  return seen_through_lobe(g, g.roughness < least_roughness ? 1 : REFRACTION_SAMPLES);
}

#ifdef REFRACTION_RAYS
// What the ray through the pixel's middle has found, or where that misses the surface the one of a neighbour; below 0:
// none did.
vec4 traced_behind(ivec2 pixel) {
  const uint image = refraction_image(3u);
  const ivec2 last = ivec2(frame.size_px) - 1;
  vec4 found = texelFetch(pass_images[image], clamp(pixel, ivec2(0), last), 0);
  for (int i = 0; i < 9 && found.a < 0.0; ++i)
    found = texelFetch(pass_images[image], clamp(pixel + ivec2(i % 3, i / 3) - 1, ivec2(0), last), 0);
  return found;
}
#endif

// scale: of the mesh's metres.
Refracted refracted_light(uint material, Surface s, BrdfTerms b, Varyings v, float scale) {
  const Glass glass = load_glass(material);
  Refracted r;
  GlassPoint g = glass_point(glass, s, b, v, scale, r.fraction);
  r.is_traced = false;
#ifdef REFRACTION_RAYS
  if (g.roughness < uintBitsToFloat(pc.own)) {
    r.light = traced_behind(ivec2(g.pixel));
    r.tint = vec3(1.0);
    r.is_traced = r.light.a >= 0.0;
    if (r.is_traced) return r;
  }
#endif
  const bool is_body = g.thickness_m > 0.0;
  vec3 absorbed = glass.absorption * g.thickness_m;
#ifdef BODIES
  if (is_body) absorbed = absorbed_by_bodies(glass, g);
#endif
  if (glass.dispersion > 0.0 && is_body) {
    // KHR_materials_dispersion: the index at three wavelengths.
    const float half_spread = (g.ior - 1.0) * 0.025 * glass.dispersion;
    const float nominal = g.ior;
    g.ior = nominal - half_spread;
    const vec4 red = seen_through(g);
    g.ior = nominal;
    const vec4 green = seen_through(g);
    g.ior = nominal + half_spread;
    const vec4 blue = seen_through(g);
    r.light = vec4(red.r, green.g, blue.b, max(red.a, max(green.a, blue.a)));
  } else {
    r.light = seen_through(g);
  }
  r.tint = glass_tint(glass, s, refraction_reflected(s, b), r.fraction, is_body, 0.0);
  if (is_body) r.tint *= exp(-absorbed);
  return r;
}
