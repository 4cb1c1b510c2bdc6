#version 460
// Light that fog scatters towards the camera, in each slice of each ray of the grid. One thread for four slices.
#include "shared/fog.h"
layout(push_constant, scalar) uniform Push { FogLightPush pc; };
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
#include "lib/fog_medium.glsl"
#include "lib/fog_ray.glsl"
#define FOG_STEEP
#include "lib/fog_light.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

void main() {
  const uvec3 id = gl_GlobalInvocationID;
  const uvec3 nodes = frame.fog.nodes;
  // Threads beside the grid follow its last rays, for the walk through the lists takes all lanes.
  const uvec2 place = min(id.xy, nodes.xy - 1u);
  const FogRay ray = fog_ray(2.0 * vec2(place) / vec2(nodes.xy - 1u) - 1.0);
  const int first = int(id.z) * FOG_RUN;
  float node_m[FOG_RUN + 1];
  for (int j = 0; j <= FOG_RUN; ++j) node_m[j] = min(fog_node_depth(first + j - 1) * ray.along, FOG_FAR);
  const vec2 cells = 2.0 * frame.tan_half / vec2(nodes.xy - 1u);
  vec3 gained[FOG_RUN];
  fog_run(ray, node_m, sqrt(cells.x * cells.y), gained);
  if (any(greaterThanEqual(id.xy, nodes.xy))) return;
  for (int j = 0; j < FOG_RUN; ++j)
    if (first + j < int(nodes.z))
      imageStore(storage_volume_images[pc.target], ivec3(id.xy, first + j),
                 vec4(gained[j], fog_steep[j]) * frame.pre_exposure);
}
