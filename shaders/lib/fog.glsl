#pragma once
// Fog between the camera and what is shaded. Transmittance and the light that fog emits are closed forms. The light
// that it scatters comes from the grid (FOG is 2), is followed along the ray of the point itself (3), or comes from
// coarse texels that followed rays (4); 1: there is none.
// Passes compile these lines only for frames with fog, by "#FOG=..." behind a shader's name (passes/shared/fog_view.h):
// shaders of other frames stay what they were, to the byte.
#include "lib/image_kinds.glsl"
#include "lib/fog_medium.glsl"
#include "lib/fog_ray.glsl"
#if FOG == 3
#include "lib/fog_light.glsl"
#elif defined(FOG_LAST)
#define FOG_RUN 1
#include "lib/fog_light.glsl"
#endif

#if FOG == 4
#include "lib/coarse_light.glsl"
#endif

struct FogSeen {
  vec3 light;    // pre-exposed
  vec3 through;  // of what lies behind
};

#if FOG == 2
// Between four rays, at a node; a: whether any of them asks for the slice before the node to be summed anew.
vec4 fog_grid_light(vec2 at, int k) {
  const ivec2 low = ivec2(at);
  const vec2 s = at - vec2(low);
  const vec4 a = texelFetch(pass_volume_images[pc.fog_light], ivec3(low, k), 0);
  const vec4 b = texelFetch(pass_volume_images[pc.fog_light], ivec3(low + ivec2(1, 0), k), 0);
  const vec4 c = texelFetch(pass_volume_images[pc.fog_light], ivec3(low + ivec2(0, 1), k), 0);
  const vec4 d = texelFetch(pass_volume_images[pc.fog_light], ivec3(low + 1, k), 0);
  return vec4(mix(mix(a.rgb, b.rgb, s.x), mix(c.rgb, d.rgb, s.x), s.y), max(max(a.a, b.a), max(c.a, d.a)));
}
#endif

vec3 fog_scattered(FogRay ray, vec2 ndc, float end_m) {
#if FOG == 2
  // Between two nodes light grows as the medium's fraction of the slice's scattering: exact where its source is
  // constant, in slices of any thickness.
  const int last = int(frame.fog.nodes.z) - 1;
  const float place = log2(max(end_m / ray.along, 1e-30) / frame.fog.nearest_m) / frame.fog.log2_ratio;
  const int k = int(clamp(floor(place), -1.0, float(last - 1)));
  const vec2 inside = fog_inside(ray.origin, ray.direction, vec2(0.0, FOG_FAR));
  const float a_m = clamp(fog_node_depth(k) * ray.along, inside.x, inside.y);
  const float b_m = clamp(min(fog_node_depth(k + 1) * ray.along, FOG_FAR), inside.x, inside.y);
#ifdef FOG_MEDIA
  const vec3 all = one_minus_exp(fog_length(ray.origin, ray.direction, a_m, b_m));
  const vec3 part = one_minus_exp(fog_length(ray.origin, ray.direction, a_m, clamp(end_m, a_m, b_m)));
#else
  const float metres = fog_length(ray.origin, ray.direction, a_m, b_m);
  const vec3 all = one_minus_exp(frame.fog.extinction * metres);
  const vec3 part =
      one_minus_exp(frame.fog.extinction * fog_length(ray.origin, ray.direction, a_m, clamp(end_m, a_m, b_m)));
#endif
  const vec2 most = vec2(frame.fog.nodes.xy) - 1.0;
  const vec2 at = clamp((ndc * 0.5 + 0.5) * most, vec2(0.0), most - 1e-4 * most);
  const vec3 before = k < 0 ? vec3(0.0) : fog_grid_light(at, k).rgb;
  const vec4 after = fog_grid_light(at, k + 1);
#ifdef FOG_LAST
  // The slice in which a surface stands, as far as it lies before it: a lamp may be behind. The sky stands in none.
  if (end_m < FOG_FAR && (FOG_LAST == 2 || after.a > 0.0)) {
    // A quarter of a pixel: a ray of its own stands for nothing but its pixel.
    const vec2 cells = 0.5 * frame.tan_half / vec2(frame.size_px);
    float node_m[FOG_RUN + 1];
    node_m[0] = min(a_m, end_m);
    node_m[1] = end_m;
    vec3 gained[FOG_RUN];
    fog_run(ray, node_m, sqrt(cells.x * cells.y), gained);
    return before + gained[0] * frame.pre_exposure;
  }
#endif
  return before + (after.rgb - before) * mix(vec3(0.0), min(part / all, 1.0), greaterThan(all, vec3(0.0)));
#elif FOG == 3
  // A quarter of a pixel: a ray of its own stands for nothing but its pixel.
  const vec2 cells = 0.5 * frame.tan_half / vec2(frame.size_px);
  const float farthest = subgroupMax(end_m);  // the walk through the lists takes all lanes
  precise vec3 sum = vec3(0.0);
  for (int first = 0; first < int(frame.fog.nodes.z); first += FOG_RUN) {
    float node_m[FOG_RUN + 1];
    for (int j = 0; j <= FOG_RUN; ++j) node_m[j] = min(fog_node_depth(first + j - 1) * ray.along, end_m);
    if (!(fog_node_depth(first - 1) < farthest)) break;
    vec3 gained[FOG_RUN];
    fog_run(ray, node_m, sqrt(cells.x * cells.y), gained);
    for (int j = 0; j < FOG_RUN; ++j) sum += gained[j];
  }
  return sum * frame.pre_exposure;
#elif FOG == 4
  const ivec2 texels = textureSize(pass_images[pc.fog_light], 0);
  return coarse_light(pc.fog_light, (ndc * 0.5 + 0.5) * vec2(frame.size_px), frame.fog.nodes.x, texels,
      min(end_m / ray.along, 1e18), true);
#else
  return vec3(0.0);
#endif
}

#ifdef FOG_MEDIA
// What several media emit has no closed form where they overlap: it is part of the slices.
FogSeen fog_seen(FogRay ray, vec2 ndc, float end_m) {
  FogSeen seen;
  seen.through = fog_through(ray.origin, ray.direction, end_m);
  seen.light = fog_scattered(ray, ndc, end_m);
  return seen;
}
#else
FogSeen fog_seen(FogRay ray, vec2 ndc, float end_m) {
  const vec2 span = fog_inside(ray.origin, ray.direction, vec2(0.0, end_m));
  const float metres = fog_length(ray.origin, ray.direction, span.x, span.y);
  FogSeen seen;
  seen.through = fog_through(metres);
  seen.light = frame.fog.glow * one_minus_exp(frame.fog.extinction * metres) * frame.pre_exposure +
      fog_scattered(ray, ndc, end_m);
  return seen;
}

#endif

// Before a point of the scene.
struct FogPlace {
  FogRay ray;
  vec2 ndc;
  float end_m;
};
FogPlace fog_place(vec3 position) {
  FogPlace p;
  const float depth = -dot(position, frame.camera_back);
  p.ndc = vec2(dot(position, frame.camera_right), -dot(position, frame.camera_up)) / frame.tan_half;
  if (frame.perspective != 0u) p.ndc /= max(depth, 1e-30);
  p.ndc = clamp(p.ndc, vec2(-2.0), vec2(2.0));
  p.ray = fog_ray(p.ndc);
  p.end_m = max(depth, 0.0) * p.ray.along;
  return p;
}
FogSeen fog_before(vec3 position) {
  const FogPlace p = fog_place(position);
  return fog_seen(p.ray, p.ndc, p.end_m);
}
vec3 fog_before_through(vec3 position) {
  const FogPlace p = fog_place(position);
  return fog_through(p.ray.origin, p.ray.direction, p.end_m);
}
FogSeen fog_before_sky(vec2 ndc) { return fog_seen(fog_ray(ndc), ndc, FOG_FAR); }
// What is not seen through fog covers what is behind the picture, by its luminance.
vec4 seen_through_fog(vec4 behind, FogSeen fog) {
  const float through = dot(fog.through, vec3(0.2126, 0.7152, 0.0722));
  return vec4(behind.rgb * fog.through + fog.light, 1.0 - through * (1.0 - behind.a));
}
