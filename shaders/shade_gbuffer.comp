#version 460
// Shades what the G-buffer holds: a pixel's samples that hold the same bits once, each other one for itself.
#define TRIANGLES
#include "shared/draw.h"
#include "shared/visibility.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#ifdef RELIEF_TEXEL
#include "lib/vertex_position.glsl"
#include "lib/vertex_attributes.glsl"
#endif
#include "lib/surface.glsl"
#include "lib/view_ray.glsl"
#include "lib/shade.glsl"
#include "lib/gbuffer.glsl"
#include "lib/gbuffer_read.glsl"
#include "lib/gbuffer_relief.glsl"
#include "lib/store_samples.glsl"
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

// What a workgroup's tile of 8x8 pixels shades: a place in the tile, 3 bits x and 3 bits y; a sample of it, 3 bits; the
// samples that hold the same bits, from bit 9 on. 0: nothing. First what the first seen sample of each pixel holds,
// then, in a list of them, what other samples hold: so all threads share the work at edges (Lauritzen 2010).
const uint tile_pixels = 64u;
shared uint items[tile_pixels * uint(SAMPLES)];
shared uint item_count;

void main() {
  const uint t = gl_LocalInvocationIndex;
  const ivec2 corner = 8 * ivec2(gl_WorkGroupID.xy), own = corner + ivec2(gl_LocalInvocationID.xy);
  items[t] = 0u;
  if (t == 0u) item_count = tile_pixels;
  barrier();
  const bool in_picture = all(lessThan(own, ivec2(frame.size_px)));
  uint left = in_picture ? (1u << SAMPLES) - 1u : 0u;
  bool is_first = true;
  while (left != 0u) {
    const int s = findLSB(left);
    const GBufferSample g = load_gbuffer(own, s);
    uint same = 1u << s;
    for (int other = s + 1; other < SAMPLES; ++other)
      if ((left >> other & 1u) != 0u && gbuffer_holds(g, own, other)) same |= 1u << other;
    left &= ~same;
    if (is_seen(g)) {
      items[is_first ? t : atomicAdd(item_count, 1u)] = t | uint(s) << 6u | same << 9u;
      is_first = false;
    } else {
      store_samples(own, same, vec4(0.0));
    }
  }
  barrier();
  for (uint i = t; i < item_count; i += tile_pixels) {
    const uint item = items[i];
    if (item == 0u) continue;
    const ivec2 at = corner + ivec2(item & 7u, item >> 3u & 7u);
    pixel_middle = vec2(at) + 0.5;
    const vec3 to_viewer = direction_to_viewer();
    const GBufferSample g = load_gbuffer(at, int(item >> 6u & 7u));
    const SurfacePoint p = surface_point_of(g, to_viewer);
#ifdef RELIEF_TEXEL
    begin_gbuffer_relief(g, p.on_triangle);
#endif
    store_samples(at, item >> 9u, shade_point(p, to_viewer));
  }
}
