#version 460
// Shaded points as they come back from a G-buffer's format.
#define TRIANGLES
#include "shared/draw.h"
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Points { float f[]; };
layout(push_constant, scalar) uniform Push {
  Points from, to;
  uint count, unused;
  vec2 subsample_ndc;
  float subsample_footprint;
  uint64_t deformed, lights;
} pc;
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/view_ray.glsl"
#include "lib/gbuffer.glsl"
layout(local_size_x = 64) in;

vec3 three(uint i) { return vec3(pc.from.f[i], pc.from.f[i + 1u], pc.from.f[i + 2u]); }
void put(uint i, vec3 v) {
  for (uint c = 0u; c < 3u; ++c) pc.to.f[i + c] = v[c];
}

void main() {
  if (gl_GlobalInvocationID.x >= pc.count) return;
  const uint i = 20u * gl_GlobalInvocationID.x;
  SurfacePoint p = no_point();
  p.position = p.on_triangle = p.at_middle = three(i);
  p.surface.normal = three(i + 3u);
  p.surface.base_color = three(i + 6u);
  p.surface.dielectric_f0 = three(i + 9u);
  p.surface.emission = three(i + 12u);
  p.surface.roughness = pc.from.f[i + 15u];
  p.surface.metallic = pc.from.f[i + 16u];
  p.surface.occlusion = pc.from.f[i + 17u];
  p.surface.dielectric_f90 = pc.from.f[i + 18u];
  p.is_unlit = pc.from.f[i + 19u] != 0.0;
  const vec2 ndc = vec2(dot(p.position, frame.camera_right), -dot(p.position, frame.camera_up)) /
      (frame.tan_half * -dot(p.position, frame.camera_back));
  pixel_middle = floor((ndc * 0.5 + 0.5) * vec2(frame.size_px)) + 0.5;
  p = point_of(gbuffer_of(p));
  put(i, p.position);
  put(i + 3u, p.surface.normal);
  put(i + 6u, p.surface.base_color);
  put(i + 9u, p.surface.dielectric_f0);
  put(i + 12u, p.surface.emission);
  pc.to.f[i + 15u] = p.surface.roughness;
  pc.to.f[i + 16u] = p.surface.metallic;
  pc.to.f[i + 17u] = p.surface.occlusion;
  pc.to.f[i + 18u] = p.surface.dielectric_f90;
  pc.to.f[i + 19u] = p.is_unlit ? 1.0 : 0.0;
}
