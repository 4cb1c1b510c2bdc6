#version 460
// Rays about the mirror direction, through the picture.
#include "shared/reflections.h"
layout(push_constant, scalar) uniform Push { ReflectionsTracePush pc; };
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
#include "lib/reflections.glsl"
#include "lib/ambient_sh.glsl"
#include "lib/axes.glsl"
#ifdef FOG
#include "lib/fog_medium.glsl"
#endif
layout(local_size_x = 64, local_size_y = 1) in;
layout(constant_id = 0) const int SIDE = 1;  // of a texel, in pixels
layout(constant_id = 1) const int HAS_SKY = 0;
#include "lib/reflections_lobe.glsl"
const float FAR = 1e15;  // metres; its square is a number

float depth_at(ivec2 p) { return texelFetch(pass_images[pc.at.z], p, 0).r; }
vec3 point_at(ivec2 p, float depth) {
  return occlusion_position(vec2(p) + 0.5, metres_of(depth), pc.subsample_ndc);
}

struct Met {
  bool hit;
  vec2 place_px;
  float metres;  // along the ray
  float depth;   // of the pixel's surface
};

// McGuire and Mara, "Efficient GPU Screen-Space Ray Tracing", 2014: even steps along the ray's line on the picture.
// Depth is linear there for both cameras, so that a step costs one lookup and no division. Where the ray passes behind
// what is seen, the place is bisected to a pixel; it is met there if the surface is seen from the side that the ray
// comes from, and the ray meets its plane there or is not farther behind it than it may be thick.
Met march(vec3 p, vec3 plane, vec3 l, float jitter) {
  Met met = Met(false, vec2(0.0), 0.0, 0.0);
  const bool perspective = frame.perspective != 0u;
  const vec2 size = vec2(frame.size_px);
  float end_m = min(FAR, 1e4 * max(-p.z, length(p)) + 1e3);
  const float near_m = perspective ? frame.clip_from_relative[3][2] : -3e38;
  // Towards the camera: to the near plane.
  if (perspective && l.z > 0.0) end_m = min(end_m, (-p.z - near_m) / l.z * 0.9999);
  if (!(end_m > 0.0)) return met;
  const vec3 end = p + l * end_m;
  const vec2 a = place_px(p), b = place_px(end);
  if (any(isnan(b)) || any(isinf(b))) return met;
  const float da = depth_of(-p.z), db = depth_of(-end.z);
  // As far as it is on the picture, and not before it has left its own pixel.
  const vec2 across = b - a;
  vec2 span = vec2(0.0, 1.0);
  for (int i = 0; i < 2; ++i) {
    if (across[i] == 0.0) continue;
    const float s = -a[i] / across[i], t = (size[i] - a[i]) / across[i];
    span = vec2(max(span.x, min(s, t)), min(span.y, max(s, t)));
  }
  const float longest = max(abs(across.x), abs(across.y));
  if (!(longest * span.y > 1.5)) return met;
  span.x = max(span.x, 1.5 / longest);
  if (!(span.y > span.x)) return met;
  const float pixels = (span.y - span.x) * longest;
  const float count = pc.steps > 0 ? min(ceil(pixels), float(pc.steps)) : min(ceil(pixels), 65536.0);
  const float stride = (span.y - span.x) / count;
  const int halvings = int(ceil(log2(max(stride * longest, 1.0))));
  const ivec2 last = ivec2(frame.size_px) - 1;
  bool was_behind = false;
  float before = span.x;
  for (float j = 0.0; j < count; j += 1.0) {
    const float s = span.x + (j + jitter) * stride;
    float scene = depth_at(clamp(ivec2(a + across * s), ivec2(0), last));
    const bool behind = scene > 0.0 && mix(da, db, s) < scene;
    if (behind) {
      float low = before, high = s;
      if (!was_behind)
        for (int i = 0; i < halvings; ++i) {
          const float middle = 0.5 * (low + high);
          const float there = depth_at(clamp(ivec2(a + across * middle), ivec2(0), last));
          if (there > 0.0 && mix(da, db, middle) < there) {
            high = middle;
            scene = there;
          } else {
            low = middle;
          }
        }
      const ivec2 q = clamp(ivec2(a + across * high), ivec2(0), last);
      scene = depth_at(q);
      const float ray_m = metres_of(mix(da, db, high)), scene_m = metres_of(scene);
      const float t = perspective ? end_m * high * metres_of(mix(da, db, high)) / -end.z : end_m * high;
      // Its triangle's plane is met within a pixel of there, or the ray passes behind it by no more than it may be
      // thick.
      const vec3 n = unpack_normal(texelFetch(pass_uint_images[pc.at.surface], q, 0).w);
      const vec3 seen = point_at(q, scene);
      const float against = -dot(n, l);
      const float plane_t = against > 1e-6 ? max(dot(n, p - seen), 0.0) / against : 0.0;
      const vec3 there = p + l * plane_t;
      bool met_it = plane_t > 0.0 && (!perspective || -there.z > near_m);
      if (met_it) {
        const vec2 off = abs(place_px(there) - (vec2(q) + 0.5));
        met_it = max(off.x, off.y) <= 1.5 || ray_m - scene_m <= pc.thickness * scene_m;
      }
      const float height = dot(plane, seen - p);
      if (met_it && height > 0.25 * t * dot(plane, l)) {
        met = Met(true, a + across * high, t, scene);
        return met;
      }
    }
    was_behind = behind;
    before = s;
  }
  return met;
}

vec3 light_at(vec2 place, float radius_px) {
  const float level = clamp(log2(max(2.0 * radius_px, 1.0)), 0.0, pc.last_level);
  const vec4 light = textureLod(sampler2D(pass_images[pc.colors], graph_samplers[SAMPLER_LINEAR_CLAMP]),
      place / pc.colors_px, level);
  return light.a > 0.0 ? light.rgb / light.a : vec3(0.0);
}

void main() {
  const uvec2 texel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(texel, pc.texels))) return;
  const ivec2 pixel = min(ivec2(texel) * SIDE, ivec2(frame.size_px) - 1);
  const float depth = depth_at(pixel);
  const vec4 reflectance = unpack_reflectance(texelFetch(pass_uint_images[pc.at.reflectance], pixel, 0).xy);
  const float wanted = reflects_scene(reflectance.a, pc.roughest);
  if (!(depth > 0.0) || reflectance.rgb == vec3(0.0) || !(wanted > 0.0)) {
    imageStore(storage_images[pc.light], ivec2(texel), vec4(0.0));
    return;
  }
  const Reflecting r = unpack_reflecting(texelFetch(pass_uint_images[pc.at.surface], pixel, 0));
  const vec3 p = point_at(pixel, depth);
  const bool perspective = frame.perspective != 0u;
  const vec3 v = perspective ? normalize(-p) : vec3(0.0, 0.0, 1.0);
  const ReflectedLobe lobe = reflected_lobe(r, v, reflectance.a);
  const uint order = pattern_of(texel + pc.pattern), parts = uint(pc.samples) * pc.of;
  const float pixel_at_1m = 2.0 * frame.tan_half.y / float(frame.size_px.y);
  LobeLight sum = LobeLight(vec3(0.0), vec3(0.0), 0.0, 0.0);
  for (int i = 0; i < pc.samples; ++i) {
    const uint part = uint(i) * pc.of + pc.first;
    LobeSample sampled;
    if (!lobe_sample(lobe, part, parts, order, sampled)) continue;
    const vec3 l = sampled.l;
    sum.all += sampled.weight;
    sum.sky_all += sampled.sky;
    if (dot(l, r.plane) <= 0.0) continue;  // into the surface: unknown
    const float jitter = fract(float(order) * 0.6180339887 + float(part) * 0.7548776662);
    const Met met = march(p, r.plane, l, jitter);
    if (!met.hit) continue;
    // As wide on the picture as at the same distance facing it.
    const float seen_m = metres_of(met.depth);
    vec3 seen =
        light_at(met.place_px, 0.5 * sampled.cone * met.metres / (pixel_at_1m * (perspective ? seen_m : 1.0)));
#ifdef FOG
    // The picture has it as far as fog lets it through to the camera.
    const vec3 at = occlusion_position(met.place_px, seen_m, pc.subsample_ndc), world = from_camera_space(at);
    const float away_m = perspective ? length(at) : seen_m;
    const vec3 from = perspective ? vec3(0.0) : world + frame.camera_back * seen_m;
    const vec3 to_camera = fog_through(from, perspective ? normalize(world) : -frame.camera_back, away_m);
    seen *= min(fog_through(from_camera_space(p), from_camera_space(l), met.metres) / max(to_camera, vec3(1e-6)),
        vec3(1e3));
#endif
    float kept = wanted;
    if (pc.fade > 0.0) {
      const vec2 edge = min(met.place_px, vec2(frame.size_px) - met.place_px) / (pc.fade * vec2(frame.size_px));
      kept *= smoothstep(0.0, 1.0, edge.x) * smoothstep(0.0, 1.0, edge.y);
    }
    sum.light += sampled.weight * seen * kept;
    sum.sky_hit += sampled.sky * kept;
  }
  imageStore(storage_images[pc.light], ivec2(texel), mean_of(sum));
}
