#version 460
// Keys of a visibility buffer (rasterize.comp) by a ray of the camera through each sample.
#include "shared/visibility.h"
layout(push_constant, scalar) uniform Push { TraceKeysPush pc; };
#include "lib/bindless.glsl"
#include "lib/frame.glsl"
#include "lib/sample_places.glsl"
#include "lib/axes.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 14) const int IS_SUBSAMPLE = 0;
layout(constant_id = 20) const int RAY_STACK = 1;
layout(constant_id = 30) const int SAMPLES = 1;
#include "lib/view_ray.glsl"
#define TRACE_ADDRESS pc.trees
#define TRACE_STACK RAY_STACK
#include "lib/trace.glsl"

// Nearest surface that hides what is behind it, as the hardware draws it: single-sided ones from their fronts alone.
uint64_t key_along(ViewRay along) {
  TraceRay ray = TraceRay(along.origin, 0.0, along.direction, TRACE_FAR);
  TraceHit passed = TRACE_NOTHING, hit;
  uint mode = 0u;
  const TraceScene s = TraceSceneRef(pc.trees).s;
  while (trace(ray, mode, passed, hit)) {
    const TraceItem item = trace_item(s, hit.item);
    const uint first = WordsRef(pc.numbers).w[hit.item];
    const bool faces = hit.back == 0u || (MaterialsRef(frame.materials).m[item.material].flags &
                                          material_double_sided) != 0u;
    if (first != absent && faces) {
      const vec3 p = along.origin + hit.t * along.direction;
      const vec4 clip = frame.clip_from_relative * vec4(p, 1.0);
      const float depth = clip.z / clip.w;
      if (depth <= 1.0)
        return uint64_t(floatBitsToUint(clamp(depth, 1e-37, 1.0))) << 32 | uint64_t(first + hit.primitive + 1u);
    }
    passed = hit;
    ray.t_min = hit.t;
    mode = TRACE_PASSED;
  }
  return 0ul;
}

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, frame.size_px))) return;
  const uint first = (pixel.y * frame.size_px.x + pixel.x) * uint(SAMPLES);
  for (int s = 0; s < SAMPLES; ++s)
    KeysRef(pc.keys).k[first + uint(s)] = key_along(view_ray(vec2(pixel) + sample_place_px(SAMPLES, uint(s))));
}
