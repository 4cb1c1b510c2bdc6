#version 460
// Nearest and farthest depth of each 16x16 tile over all samples of its pixels, and which of the 32 slices between them
// hold a surface (Harada 2012). Sky does not count.
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "shared/scene.h"
layout(push_constant, scalar) uniform Push { TileDepthPush pc; };
#include "lib/frame.glsl"
#include "lib/bindless.glsl"
#include "lib/light_cells.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
layout(constant_id = 0) const int SAMPLES = 1;

shared uint nearest, farthest, slices;

float sample_depth(ivec2 p, int s) {
  return SAMPLES > 1 ? texelFetch(pass_multisampled_images[pc.depth], p, s).r
      : texelFetch(pass_images[pc.depth], p, 0).r;
}
// Metres in front of the camera. Perspective: depth = near/z. Orthographic: depth = z_scale * -z_view + z_bias.
float depth_m(float d) {
  const mat4 m = frame.clip_from_relative;
  if (frame.perspective != 0u) return m[3][2] / d;
  const vec3 row = vec3(m[0][2], m[1][2], m[2][2]);
  return max((m[3][2] - d) / length(row), 0.0);
}

void main() {
  if (gl_LocalInvocationIndex == 0u) {
    nearest = 0xffffffffu;
    farthest = 0u;
    slices = 0u;
  }
  barrier();
  const ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  const bool inside = all(lessThan(uvec2(p), frame.size_px));
  // Fetched once: fetches are most of this pass. Below 0: no surface.
  float z[SAMPLES];
  uint low = 0xffffffffu, high = 0u;
  for (int s = 0; s < SAMPLES; ++s) {
    const float d = inside ? sample_depth(p, s) : 0.0;
    z[s] = d > 0.0 ? depth_m(d) : -1.0;
    if (z[s] < 0.0) continue;
    low = min(low, floatBitsToUint(z[s]));
    high = max(high, floatBitsToUint(z[s]));
  }
  low = subgroupMin(low);
  high = subgroupMax(high);
  if (subgroupElect()) {
    atomicMin(nearest, low);
    atomicMax(farthest, high);
  }
  barrier();
  TileDepth tile = TileDepth(0.0, 0.0, 0u);
  const bool seen = nearest <= farthest;
  if (seen) {
    // A point is shaded at a depth that differs from the pre-pass's by rounding and, where its pixel is partly covered,
    // by more: this only makes lists serve more of them (lib/light_list.glsl checks).
    tile.z_near = uintBitsToFloat(nearest) * (1.0 - 1.0 / 1024.0);
    tile.z_far = min(uintBitsToFloat(farthest) * (1.0 + 1.0 / 1024.0), 3e38);
    uint mask = 0u;
    for (int s = 0; s < SAMPLES; ++s) {
      if (z[s] < 0.0) continue;
      mask |= 1u << tile_slice(tile, z[s] * (1.0 - 1.0 / 4096.0));
      mask |= 1u << tile_slice(tile, z[s] * (1.0 + 1.0 / 4096.0));
    }
    mask = subgroupOr(mask);
    if (subgroupElect()) atomicOr(slices, mask);
  }
  barrier();
  if (gl_LocalInvocationIndex != 0u) return;
  tile.mask = slices;
  TileDepthsRef(pc.tiles).t[gl_WorkGroupID.y * frame.grid.tiles.x + gl_WorkGroupID.x] = tile;
}
