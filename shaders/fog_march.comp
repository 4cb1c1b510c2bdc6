#version 460
// Light that fog scatters towards the camera, for coarse texels, along the ray of the pixel that each follows: the
// seed's march (src/passes/volumes/fog_march.h).
#include "shared/fog.h"
layout(push_constant, scalar) uniform Push { FogMarchPush pc; };
#include "lib/frame.glsl"
#include "lib/image_kinds.glsl"
layout(constant_id = 0) const int DEPTH_SAMPLES = 0;
#include "lib/coarse_depth.glsl"
#include "lib/fog_medium.glsl"
#include "lib/fog_ray.glsl"
#define FOG_JITTER
#include "lib/fog_light.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

// Steps, in the grid's nearest depths.
const float SHORTEST = 0.2, LONGEST = 100.0;

// Optical depth over a stretch, the mean of the channels.
float mean_depth(FogRay ray, float begin_m, float end_m) {
#ifdef FOG_MEDIA
  return min(dot(fog_length(ray.origin, ray.direction, begin_m, end_m), vec3(1.0 / 3.0)), 1e6);
#else
  const vec2 span = fog_inside(ray.origin, ray.direction, vec2(begin_m, end_m));
  return min(dot(frame.fog.extinction, vec3(1.0 / 3.0)) * fog_length(ray.origin, ray.direction, span.x, span.y), 1e6);
#endif
}

void main() {
  const uvec2 texel = min(gl_GlobalInvocationID.xy, pc.texels - 1u);
  float metres;
  const ivec2 pixel = coarse_pixel(texel, pc.texel_px, coarse_checkerboard, metres);
  const FogRay ray = fog_ray(coarse_ndc(pixel));
  const float end_m = min(metres * ray.along, FOG_FAR);
  const vec2 cells = 0.5 * float(pc.texel_px) * frame.tan_half / vec2(frame.size_px);
  // Interleaved gradient noise (Jimenez 2014), of the texel and the job's seed, never of the frame's number.
  const vec2 place = vec2(texel + uvec2(pc.seed & 63u, pc.seed >> 6 & 63u));
  const float noise = fract(52.9829189 * fract(dot(place, vec2(0.06711056, 0.00583715))));
  const float shortest_m = SHORTEST * frame.fog.nearest_m, longest_m = LONGEST * frame.fog.nearest_m;
  float at = fog_inside(ray.origin, ray.direction, vec2(0.0, end_m)).x, depth = 0.0;
  precise vec3 sum = vec3(0.0);
  for (uint first = 0u; first < pc.steps; first += uint(FOG_RUN)) {
    if (subgroupMin(at - end_m) >= 0.0) break;  // the walk through the lists takes all lanes
    float node_m[FOG_RUN + 1];
    node_m[0] = min(at, end_m);
    for (int j = 0; j < FOG_RUN; ++j) {
      const float left = exp(-depth), extinction = mean_depth(ray, at, at + shortest_m) / shortest_m;
      float step = longest_m;
      if (left > pc.loss && extinction > 0.0) step = clamp(-log(1.0 - pc.loss / left) / extinction, shortest_m, step);
      // The last one goes to the end: nothing of the ray is left out.
      const float next = first + uint(j) + 1u >= pc.steps ? end_m : min(at + step, end_m);
      depth = min(depth + mean_depth(ray, at, next), 1e6);
      at = next;
      node_m[j + 1] = next;
      fog_jitter[j] = fract(noise + 0.618033989 * float(first + uint(j)));
    }
    vec3 gained[FOG_RUN];
    fog_run(ray, node_m, sqrt(cells.x * cells.y), gained);
    for (int j = 0; j < FOG_RUN; ++j) sum += gained[j];
  }
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, pc.texels))) return;
  imageStore(storage_images[pc.target], ivec2(texel), vec4(sum * frame.pre_exposure, metres));
}
