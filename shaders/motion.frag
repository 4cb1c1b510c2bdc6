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
// A place of a relief in clip space, where its triangle's corners are posed so and it lies `depth` below them. The same
// arithmetic for both times.
vec3 relief_clip(Item item, Geometry g, Transform t, uint64_t base, float depth, mat4 clip_from_relative) {
  const Corners c = load_corners(frame.indices, item, g, uint(gl_PrimitiveID));
  vec3 p[3];
  for (int i = 0; i < 3; ++i) p[i] = load3(base, g.position + 3u * c.v[i]);
  precise vec3 front = normalize_or(cross(p[1] - p[0], p[2] - p[0]), vec3(0.0));
  const vec3 w = relief_at.weights;
  precise vec3 local = w.x * p[0] + w.y * p[1] + w.z * p[2] - depth * front;
  precise vec3 relative = transform_point(t, local);
  precise vec4 clip = clip_from_relative * vec4(relative, 1.0);
  return clip.xyw;
}
// The height at the same place of the mesh at the time before.
float relief_height_before(ReliefRecord record) {
  Relief r = relief_point.layer;
  if (relief_point.back || (r.u_row == record.u_row_before && r.v_row == record.v_row_before))
    return relief_point.at.z;
  const float now = relief_height(r, relief_point.at.xy);
  r.u_row = record.u_row_before;
  r.v_row = record.v_row_before;
  return relief_point.at.z + (relief_height(r, relief_point.at.xy) - now);
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
  const Geometry g = load_geometry(item.geometry);
  const ReliefRecord record = relief_record(m.relief);
  const bool is_deformed = (g.flags & geometry_deformed) != 0u;
  const vec3 now_clip = relief_clip(item, g, TransformsRef(frame.transforms).t[item.transform],
      is_deformed ? pc.deformed : frame.vertices, record.depth * relief_point.at.z, frame.clip_from_relative);
  const vec3 before_clip = relief_clip(item, g, MotionRef(pc.table).t[item.transform],
      is_deformed ? pc.deformed_before : frame.vertices, record.depth_before * relief_height_before(record),
      MotionRef(pc.table).motion.clip_from_relative);
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
