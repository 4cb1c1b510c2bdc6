#version 460
// From each slice's light to that of all slices up to its end, front to back; and whether a surface that stands in the
// slice sums it for itself (fog.last), because lamps near the slice give more than a tenth of all up to its end.
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
  const int ahead = 8;  // slices that are loaded before the first of them is added
  precise vec3 sum = vec3(0.0);
  for (int first = 0; first < int(nodes.z); first += ahead) {
    vec4 gained[ahead];
    for (int i = 0; i < ahead; ++i)
      gained[i] = imageLoad(storage_volume_images[pc.image], ivec3(place, min(first + i, int(nodes.z) - 1)));
    for (int i = 0; i < ahead && first + i < int(nodes.z); ++i) {
      sum += gained[i].rgb;
      imageStore(storage_volume_images[pc.image], ivec3(place, first + i),
                 vec4(sum, gained[i].a > 0.1 * max(sum.r, max(sum.g, sum.b)) ? 1.0 : 0.0));
    }
  }
}
