// Keys of a visibility buffer (rasterize.comp) by a ray of the camera through each sample. Needs lib/frame.glsl and
// lib/trace.glsl.
layout(constant_id = 30) const int SAMPLES = 1;
#include "lib/sample_places.glsl"

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

void put_keys(uvec2 pixel) {
  const uint first = (pixel.y * frame.size_px.x + pixel.x) * uint(SAMPLES);
  for (int s = 0; s < SAMPLES; ++s)
    KeysRef(pc.keys).k[first + uint(s)] = key_along(view_ray(vec2(pixel) + sample_place_px(SAMPLES, uint(s))));
}
