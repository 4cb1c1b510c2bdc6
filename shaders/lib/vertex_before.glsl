// Where a vertex was at the time before, by the arithmetic of lib/vertex_position.glsl: what has not moved is at the
// same place bit for bit. Needs lib/scene.glsl, pc.table, a Motion, and pc.deformed_before.
#include "shared/motion.h"

vec4 clip_position_before(Item item, Geometry g, uint vertex) {
  const Transform t = MotionRef(pc.table).t[item.transform];
  const uint64_t base = (g.flags & geometry_deformed) != 0u ? pc.deformed_before : frame.vertices;
  precise vec3 p = transform_point(t, load3(base, g.position + 3u * vertex));
  precise vec4 clip = MotionRef(pc.table).motion.clip_from_relative * vec4(p, 1.0);
  return clip;
}
