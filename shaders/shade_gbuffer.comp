#version 460
// Shades what the G-buffer holds: a pixel's samples that hold the same bits once, each other one for itself.
#define TRIANGLES
#include "shared/draw.h"
#include "shared/visibility.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/view_ray.glsl"
#include "lib/shade.glsl"
#include "lib/gbuffer.glsl"
#include "lib/gbuffer_read.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

vec4 shade_point(SurfacePoint p, vec3 to_viewer) {
  precise vec3 radiance = p.surface.emission;
  if (!p.is_unlit) {
    begin_rays(p.on_triangle, p.plane_normal);
    radiance =
        surface_radiance(p.surface, brdf_terms(p.surface, to_viewer), p.position, p.on_triangle, p.plane_normal);
  }
#ifdef FOG
  const FogSeen fog = fog_before(p.position);
  return vec4(radiance * frame.pre_exposure * fog.through + fog.light, 1.0);
#else
  return vec4(radiance * frame.pre_exposure, 1.0);
#endif
}

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, frame.size_px))) return;
  pixel_middle = vec2(pixel) + 0.5;
  const ivec2 at = ivec2(pixel);
  const uint first = (pixel.y * frame.size_px.x + pixel.x) * uint(SAMPLES);
  const vec3 to_viewer = direction_to_viewer();
  SamplesRef samples = SamplesRef(pc.deformed_before);
  uint left = (1u << SAMPLES) - 1u;
  while (left != 0u) {
    const int s = findLSB(left);
    const GBufferSample g = load_gbuffer(at, s);
    uint same = 1u << s;
    for (int other = s + 1; other < SAMPLES; ++other)
      if ((left >> other & 1u) != 0u && gbuffer_holds(g, at, other)) same |= 1u << other;
    left &= ~same;
    vec4 radiance = vec4(0.0);
    if (is_seen(g)) radiance = shade_point(surface_point_of(g, to_viewer), to_viewer);
    for (int other = s; other < SAMPLES; ++other)
      if ((same >> other & 1u) != 0u) samples.s[first + uint(other)] = radiance;
  }
}
