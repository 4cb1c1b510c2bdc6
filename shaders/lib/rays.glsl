#pragma once
// Rays from the point of a surface that a pixel shows: where they begin, which way they go, and what comes along them.
// Needs the push constants pc.trees, pc.rays (RaySettings) and pc.subsample, lib/features.glsl, lib/frame.glsl,
// lib/bindless.glsl and PIXEL_MIDDLE.
#include "lib/axes.glsl"
#include "lib/filtered_sky.glsl"
#include "lib/openness.glsl"
#include "lib/ray_sequence.glsl"
#include "lib/visible_normal.glsl"
#include "shared/split_sum.h"
#include "shared/trace.h"
#define TRACE_ADDRESS pc.trees
#define TRACE_STACK RAY_STACK
#include "lib/trace.glsl"
#ifdef RELIEFS
#include "lib/trace_own_relief.glsl"
#endif

TracePoint rays_from;    // of this fragment
vec3 rays_side;          // its normal on the viewer's side
#ifdef SCATTERS
vec3 rays_begin;         // its place; rays to lights behind a body's slab begin beyond that
#endif
const float BEFORE_END = 1.0 - 4e-6;  // keeps a ray off what it is aimed at

// position: of the fragment, relative; normal: of its triangle, on the viewer's side. False: none of the trees'
// triangles is there.
bool find_origin(vec3 position, vec3 normal) {
  const float reach = trace_largest(position);
  TraceRay ray = TraceRay(vec3(0.0), 0.999, position, 1.001);
  if (frame.perspective == 0u) {
    ray.direction = -frame.camera_back * max(reach, max(frame.tan_half.x, frame.tan_half.y));
    ray.origin = position - ray.direction;
  }
  TraceHit hit;
  // Lanes beside the triangle may be anywhere.
  bool found = reach < 1e18 && trace(ray, TRACE_LOCATE, TRACE_NOTHING, hit);
#ifdef RELIEFS
  // A relief lies elsewhere than its triangle, near which it would be looked for: it is what a ray of the camera meets.
  if (reach < 1e18 && !(found && abs(hit.t - 1.0) < 1e-5)) {
    TraceHit met, passed = TRACE_NOTHING;
    uint mode = 0u;
    ray.t_min = 0.0;
    for (int i = 0; i < RELIEF_MOST_BEFORE; ++i) {
      if (!trace(ray, mode, passed, met)) break;
      if (met.t > 0.999) {
        found = true;
        hit = met;
        break;
      }
      passed = met;
      mode = TRACE_PASSED;
    }
  }
#endif
  if (found) {
    rays_from = trace_point(hit);
#ifdef ROUNDED
    // Lifted as the point is.
    if ((trace_item(TraceSceneRef(TRACE_ADDRESS).s, hit.item).flags & trace_rounded) != 0u)
      rays_from = trace_free_point(rays_from.position + normal * max(dot(position - rays_from.position, normal), 0.0),
          normal, rays_from.error_m);
#endif
  } else {  // none of the trees' triangles: a line, a point, or an edge where the rasterizer covers more
    rays_from = trace_free_point(position, normal, 3.8146973e-6 * reach);
  }
  if (rays_from.normal == vec3(0.0)) rays_from.normal = normal;
#ifdef SCATTERS
  rays_begin = rays_from.position;
#endif
  rays_side = dot(rays_from.normal, normal) < 0.0 ? -rays_from.normal : rays_from.normal;
  return found;
}

// Of the light along a ray, what comes through: nothing behind opaque surfaces, what blended ones leave. A surface at
// distance t hides saturate((radius - t) / fade) of what is behind it. through: what is left of it already.
float rays_through_rest(TraceRay ray, uint mode, float radius, float fade, float through) {
  TraceHit passed = TRACE_NOTHING;
  mode |= TRACE_LIGHT;
  if (RAYS_MEET_BLENDED == 0 && fade == 0.0) mode |= TRACE_ANY;
  while (true) {
    TraceHit hit;
    if (!trace(ray, mode, passed, hit)) return through;
    float coverage = 1.0;
    if (RAYS_MEET_BLENDED != 0) {
      const TraceScene s = TraceSceneRef(TRACE_ADDRESS).s;
      const TraceItem item = trace_item(s, hit.item);
      if ((item.flags & trace_blended) != 0u) coverage = trace_coverage(s, item, hit.primitive, hit.u, hit.v);
    }
    through *= 1.0 - (fade == 0.0 ? coverage : coverage * clamp((radius - hit.t) / fade, 0.0, 1.0));
    if (coverage >= 1.0 || !(through > 0.0)) return through;
    passed = hit;
    ray.t_min = hit.t;
    mode |= TRACE_PASSED;
  }
}
float rays_through(TraceRay ray, uint mode, float radius, float fade) {
#ifdef RELIEFS
  float through = 1.0;
  const float own = trace_own_relief(rays_from, ray);
  if (own >= 0.0) through = 1.0 - (fade == 0.0 ? 1.0 : clamp((radius - own) / fade, 0.0, 1.0));
  if (through > 0.0) through = rays_through_rest(ray, mode, radius, fade, through);
  trace_left.item = no_trace;
  return through;
#else
  return rays_through_rest(ray, mode, radius, fade, 1.0);
#endif
}

// What rays find of the sky, as means over directions by the cosine about the triangle's normal: whether it is open
// there, and how bright it is, all of it and as far as it is open.
struct SkyOpen {
  float fraction, bright, bright_open;
  vec3 bent;      // mean open direction, a unit vector
  float mirror;   // how open the mirror direction of a viewer is, by the triangle's normal
  float lights;   // how open the direction is of the bright spot that a glossy surface reflects most of to that viewer
};
// The light of a bright spot on a surface, by luminance. normal: in the sky's axes.
float of_sky_light(SkyLight light, vec3 normal) {
  return min(max(dot(normal, light.direction), 0.0) * dot(light.illuminance, vec3(0.2126, 0.7152, 0.0722)), 1e30);
}
// By how much more of a spot's light a surface of roughness 0.35 reflects to a viewer than it scatters: smooth surfaces
// mirror the image itself, and rough ones care little. All in the sky's axes.
float sky_light_reflected(vec3 normal, vec3 to_viewer, vec3 to_light) {
  const float alpha2 = 0.015;
  const vec3 h = to_light + to_viewer;
  const float n_h = dot(normal, h), k = 1.0 - n_h * n_h * (1.0 - alpha2) / max(dot(h, h), 1e-12);
  return 1.0 / (k * k);
}
struct SkyLightsFound {
  float all;       // light of all spots on the surface
  vec3 reflected;  // direction to the one that it reflects most of; 0: there is none above it
};
// In the sky's axes. Always the strongest one, so that neighbouring texels agree: the answer is not filtered.
SkyLightsFound find_sky_lights(vec3 normal, vec3 to_viewer) {
  SkyLightsFound found = SkyLightsFound(0.0, vec3(0.0));
  float most = 0.0;
  for (uint i = 0u; i < frame.image_light.light_count; ++i) {
    const SkyLight light = SkyLightsRef(frame.image_light.lights).s[i];
    const float part = of_sky_light(light, normal);
    found.all += part;
    const float reflected = part * sky_light_reflected(normal, to_viewer, light.direction);
    if (!(reflected > most)) continue;
    most = reflected;
    found.reflected = light.direction;
  }
  return found;
}
// A spot by its share of the light of all. u: from 0 to 1.
vec3 chosen_sky_light(vec3 normal, float all, float u) {
  float left = u * all;
  vec3 d = normal;
  for (uint i = 0u; i < frame.image_light.light_count; ++i) {
    const SkyLight light = SkyLightsRef(frame.image_light.lights).s[i];
    const float part = of_sky_light(light, normal);
    if (part > 0.0) d = light.direction;
    left -= part;
    if (left < 0.0) break;
  }
  return d;
}
// Rays of a stretch of the sequence: `count` by the cosine from number `first` on, a quarter as many to bright spots,
// which the filtered sky does not hold, and with `reflects` two for what is reflected to a viewer in unit direction
// to_viewer; from four rays to spots on these tell of reflections too. own: of the pixel, turns the sequence over. One
// loop sends all of them: the traversal is the largest part of the shader, and stands in it once.
SkyOpen sky_open(bool bends, bool reflects, vec3 to_viewer, uint first, uint count, uvec2 own) {
  const RaySettings s = RaySettingsRef(pc.rays).s;
  const mat3 axes = axes_about(rays_side);
  const bool lit = IBL_METHOD != 0 && sky_has_lights();
  SkyLightsFound spots = SkyLightsFound(0.0, vec3(0.0));
  const vec3 normal = in_sky(rays_side), viewer = in_sky(to_viewer);
  if (lit) spots = find_sky_lights(normal, viewer);
  const uint to_spots = max(count / 4u, 1u), mirror = count + (spots.all > 0.0 ? to_spots : 0u);
  const uint end = reflects ? mirror + (lit ? 2u : 1u) : mirror;
  SkyOpen sum = SkyOpen(0.0, 0.0, 0.0, vec3(0.0), 1.0, 0.0);
  float of_spots = 0.0;
  vec2 reflected = vec2(0.0);  // of spots: what is open, and all
  for (uint i = 0u; i < end; ++i) {
    vec3 d;
    float along = 0.0, weight = 0.0;
    if (i < count) {
      const vec2 u = rays_place(first + i, own);
      const float across = sqrt(u.x), phi = 2.0 * PI * u.y;
      along = sqrt(max(1.0 - u.x, 0.0));
      d = axes * vec3(across * cos(phi), across * sin(phi), along);
    } else if (i < mirror) {
      d = chosen_sky_light(normal, spots.all, rays_place(first / count * to_spots + i - count, ~own).x);
      weight = sky_light_reflected(normal, viewer, d);
      d = from_sky(d);
    } else {
      d = i == mirror ? reflect(-to_viewer, rays_side) : from_sky(spots.reflected);
      if (!(dot(d, rays_side) > 0.0)) continue;
    }
    const float hidden = 1.0 - rays_through(TraceRay(leaving_origin(rays_from, d), 0.0, d, s.occlusion_radius_m), 0u,
        s.occlusion_radius_m, s.occlusion_fade_m);
    const float open = 1.0 - s.occlusion_strength * hidden;
    if (i < count) {
      const float bright = sky_brightness(d, PI / (float(count) * max(along, 0.1)));
      sum.fraction += open;
      sum.bright += bright;
      sum.bright_open += open * bright;
      if (bends) sum.bent += (1.0 - hidden) * d;
    } else if (i < mirror) {
      of_spots += open;
      reflected += weight * vec2(open, 1.0);
    } else if (i == mirror) {
      sum.mirror = open;
    } else {
      sum.lights = open;
    }
  }
  if (to_spots >= 4u && reflected.y > 0.0) sum.lights = reflected.x / reflected.y;
  const float each = 1.0 / float(count), bright_spots = spots.all / PI;  // as a mean by the cosine
  return SkyOpen(sum.fraction * each, sum.bright * each + bright_spots,
      sum.bright_open * each + bright_spots * (of_spots / float(to_spots)),
      dot(sum.bent, sum.bent) > 1e-12 ? normalize(sum.bent) : rays_side, sum.mirror, sum.lights);
}
SkyOpen sky_open(bool bends) {
  const uint count = rays_share(RaySettingsRef(pc.rays).s.occlusion_rays);
  return sky_open(bends, false, rays_side, rays_first(count), count, rays_own(0u));
}
// Where the mean open direction is asked for, that tells where light comes from.
Openness openness(SkyOpen o) {
  const float diffuse = OCCLUSION_IS_BENT ? o.fraction : open_diffuse(o.fraction, o.bright, o.bright_open);
  return Openness(o.fraction, diffuse, -1.0, -1.0, -1.0, o.bent);
}
// Of the light that facets about `normal` reflect towards unit `to_viewer` of this sky, by rays in directions of the
// facets that the viewer sees (Heitz 2018), as fractions of what they would bring. f0: of the facets, by luminance.
float lobe_open(vec3 normal, vec3 to_viewer, float roughness, float f0) {
  const RaySettings s = RaySettingsRef(pc.rays).s;
  const uint count = rays_share(s.occlusion_rays), first = rays_first(count);
  const uvec2 own = rays_own(3u);
  const float alpha = max(roughness, least_roughness) * max(roughness, least_roughness), alpha2 = alpha * alpha;
  const mat3 axes = axes_about(normal);
  vec3 v = to_viewer * axes;
  v = normalize(vec3(v.xy, max(v.z, 1e-4)));
  const vec3 stretched = normalize(vec3(alpha * v.xy, v.z));
  const float across2 = dot(stretched.xy, stretched.xy);
  const vec3 t1 = across2 > 1e-12 ? vec3(-stretched.y, stretched.x, 0.0) * inversesqrt(across2) : vec3(1.0, 0.0, 0.0);
  const vec3 t2 = cross(stretched, t1);
  const float masked = sqrt(v.z * v.z * (1.0 - alpha2) + alpha2), g1 = 2.0 * v.z / (v.z + masked);
  float all = 0.0, arriving = 0.0;
  for (uint i = 0u; i < count; ++i) {
    const vec2 u = rays_place(first + i, own);
    const float phi = 2.0 * PI * u.y;
    const vec3 h = visible_normal(stretched, t1, t2, vec2(alpha), sqrt(u.x) * vec2(cos(phi), sin(phi)));
    const float v_h = dot(v, h);
    const vec3 l = 2.0 * v_h * h - v;
    if (l.z <= 0.0 || v_h <= 0.0) continue;
    const vec3 d = axes * l;
    const float x = clamp(1.0 - v_h, 0.0, 1.0), x2 = x * x, fresnel = f0 + (1.0 - f0) * (x2 * x2 * x);
    const float shadowed = 2.0 * l.z * v.z / (l.z * masked + v.z * sqrt(l.z * l.z * (1.0 - alpha2) + alpha2)) / g1;
    const float k = dot(h.xy, h.xy) + h.z * h.z * alpha2, pdf = g1 * alpha2 / (4.0 * PI * k * k * v.z);
    const float light = fresnel * shadowed * sky_reflected(d, 1.0 / (float(count) * pdf), roughness);
    all += light;
    float hidden = 1.0;  // into the surface itself
    if (dot(d, rays_side) > 0.0)
      hidden -= rays_through(TraceRay(leaving_origin(rays_from, d), 0.0, d, s.occlusion_radius_m), 0u,
          s.occlusion_radius_m, s.occlusion_fade_m);
    arriving += light * (1.0 - s.occlusion_strength * hidden);
  }
  return all > 0.0 ? clamp(arriving / all, 0.0, 1.0) : 1.0;
}
