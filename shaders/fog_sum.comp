#version 460
// From each slice's light to that of all slices up to its end, front to back.
#include "shared/fog.h"
layout(push_constant, scalar) uniform Push { FogSumPush pc; };
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
layout(local_size_x = 64) in;

void main() {
  const uint column = gl_GlobalInvocationID.x;
  const uvec3 nodes = frame.fog.nodes;
  if (column >= nodes.x * nodes.y) return;
  const ivec2 place = ivec2(column % nodes.x, column / nodes.x);
  precise vec3 sum = vec3(0.0);
  for (int k = 0; k < int(nodes.z); ++k) {
    sum += imageLoad(storage_volume_images[pc.image], ivec3(place, k)).rgb;
    imageStore(storage_volume_images[pc.image], ivec3(place, k), vec4(sum, 0.0));
  }
}
