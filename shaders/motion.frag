#version 460
// How far the point of the surface has moved in the picture, in pixels, y up.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/draw.frag.glsl"

#ifdef RELIEF
#include "lib/vertex_before.glsl"
// A place of a relief in clip space, where its triangle's corners are posed so. The same arithmetic for both times.
vec3 relief_clip(Transform t, uint64_t base, mat4 clip_from_relative) {
  const Item item = load_item(in_item);
  const Geometry g = load_geometry(item.geometry);
  const Corners c = load_corners(frame.indices, item, g, uint(gl_PrimitiveID));
  vec3 p[3];
  for (int i = 0; i < 3; ++i) p[i] = load3(base, g.position + 3u * c.v[i]);
  const float depth = relief_record(load_material(item.material).relief).depth * relief_point.at.z;
  precise vec3 front = normalize_or(cross(p[1] - p[0], p[2] - p[0]), vec3(0.0));
  const vec3 w = relief_at.weights;
  precise vec3 local = w.x * p[0] + w.y * p[1] + w.z * p[2] - depth * front;
  precise vec3 relative = transform_point(t, local);
  precise vec4 clip = clip_from_relative * vec4(relative, 1.0);
  return clip.xyw;
}
#endif
layout(location = 8) in vec3 in_now;     // clip space without its depth
layout(location = 9) in vec3 in_before;  // the same of the time before

layout(location = 0) out vec2 out_motion_px;

void main() {
  const Material m = load_material(in_ids.x);
#ifdef RELIEF
  load_varyings();
  const Item item = load_item(in_item);
  const bool is_deformed = (load_geometry(item.geometry).flags & geometry_deformed) != 0u;
  const vec3 now_clip = relief_clip(TransformsRef(frame.transforms).t[item.transform],
      is_deformed ? pc.deformed : frame.vertices, frame.clip_from_relative);
  const vec3 before_clip = relief_clip(MotionRef(pc.table).t[item.transform],
      is_deformed ? pc.deformed_before : frame.vertices, MotionRef(pc.table).motion.clip_from_relative);
#else
  const vec3 now_clip = in_now, before_clip = in_before;
#endif
  if (IS_MASKED != 0 && surface_coverage(m, surface_base_color(m, load_varyings()).a) == 0.0) discard;
  vec2 moved = vec2(0.0);
  // Behind the camera nothing has a place; beside it the place may be farther than a float reaches.
  if (before_clip.z > 0.0) {
    precise vec2 now = now_clip.xy / now_clip.z;
    precise vec2 before = before_clip.xy / before_clip.z;
    precise vec2 difference = now - before;
    moved = difference * vec2(0.5, -0.5) * vec2(frame.size_px);
    if (!(abs(moved.x) < 3.4e38 && abs(moved.y) < 3.4e38)) moved = vec2(0.0);
  }
  out_motion_px = moved;
}
