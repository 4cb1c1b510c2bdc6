#pragma once
// What reflections of the scene put in place of the sky's, of a pixel. Needs lib/frame.glsl, lib/bindless.glsl, pc.at,
// pc.light, pc.texels and pc.subsample_ndc; and of the frame at all its samples pc.depth or pc.keys
// (lib/frame_depth.glsl).
#include "lib/frame_depth.glsl"
#include "lib/reflections.glsl"
layout(constant_id = 0) const int SIDE = 1;     // of a texel, in pixels
layout(constant_id = 1) const int SAMPLES = 1;  // of the frame's depth

vec3 point_at(ivec2 p, float depth) {
  return occlusion_position(vec2(p) + 0.5, metres_of(depth), pc.subsample_ndc);
}

void find_reflected(ivec2 pixel, out vec3 gained, out vec3 taken) {
  const float depth = texelFetch(pass_images[pc.at.z], pixel, 0).r;
  const vec3 fraction = unpack_reflectance(texelFetch(pass_uint_images[pc.at.reflectance], pixel, 0).xy).rgb;
  gained = taken = vec3(0.0);
  if (depth > 0.0 && fraction != vec3(0.0)) {
    const vec3 p = point_at(pixel, depth);
    const vec3 plane = unpack_normal(texelFetch(pass_uint_images[pc.at.surface], pixel, 0).w);
    vec4 light = vec4(0.0);
    if (SIDE == 1) {
      light = texelFetch(pass_images[pc.light], pixel, 0);
    } else {
      // The four texels about the pixel, each by how near its surface lies to this one's plane; else the most alike.
      const vec2 at = vec2(pixel) / float(SIDE), f = fract(at);
      const ivec2 corner = ivec2(at), last = ivec2(pc.texels) - 1;
      vec4 nearest = vec4(0.0);
      float weights = 0.0, most = -1.0;
      for (int i = 0; i < 4; ++i) {
        const ivec2 o = ivec2(i & 1, i >> 1), texel = min(corner + o, last);
        const ivec2 other = min(texel * SIDE, ivec2(frame.size_px) - 1);
        const float z = texelFetch(pass_images[pc.at.z], other, 0).r;
        if (!(z > 0.0)) continue;
        const vec3 there = unpack_reflectance(texelFetch(pass_uint_images[pc.at.reflectance], other, 0).xy).rgb;
        if (there == vec3(0.0)) continue;
        const float like = occlusion_likeness(point_at(other, z), p, plane);
        const vec4 value = texelFetch(pass_images[pc.light], texel, 0);
        const vec2 b = mix(1.0 - f, f, vec2(o));
        light += b.x * b.y * like * value;
        weights += b.x * b.y * like;
        if (like > most) {
          most = like;
          nearest = value;
        }
      }
      light = weights > 1e-3 ? light / weights : nearest;
    }
    // The sky that is left: what the rays leave, or what near surfaces do, whichever is less.
    const vec4 sky = texelFetch(pass_images[pc.at.sky], pixel, 0);
    gained = fraction * light.rgb;
    taken = sky.rgb * max(sky.a - min(sky.a, 1.0 - light.a), 0.0);
    // Of the pixel's samples, as many as are of this surface: within a quarter of what a pixel is wide there of its
    // plane. More would take from a wall what the floor before it has of the sky.
    if (SAMPLES > 1) {
      const float pixel_m = (frame.perspective != 0u ? -p.z : 1.0) * 2.0 * frame.tan_half.y / float(frame.size_px.y);
      float of_surface = 0.0;
      for (int s = 0; s < SAMPLES; ++s) {
        const float d = frame_depth(pixel, s, SAMPLES);
        if (!(d > 0.0)) continue;
        const vec2 place = vec2(pixel) + sample_place_px(SAMPLES, uint(s));
        const vec3 q = occlusion_position(place, metres_of(d), pc.subsample_ndc);
        if (abs(dot(plane, q - p)) <= 0.25 * pixel_m) of_surface += 1.0 / float(SAMPLES);
      }
      gained *= of_surface;
      taken *= of_surface;
    }
  }
}
