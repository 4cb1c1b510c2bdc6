// Frustum test of one item's box (TECHNIQUES 2.1). Written so that NaN and infinite bounds are kept, and rounding never
// culls.
#include "lib/frame.glsl"
#include "shared/cull.h"
layout(push_constant, scalar) uniform Push { CullPush pc; };
layout(local_size_x = 256) in;

uint group_index() { return gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x; }

bool item_survives(uint index) {
  if (pc.culling == 0u) return true;
  const Item item = ItemsRef(frame.items).i[index];
  for (int p = 0; p < 5; ++p) {
    const vec4 plane = frame.planes[p];
    const float reach = dot(abs(plane.xyz), item.bounds_extent);
    const float distance = dot(plane.xyz, item.bounds_centre) + plane.w;
    const float rounding = 4.0 * 1.1920929e-7 * (dot(abs(plane.xyz), abs(item.bounds_centre)) + reach + abs(plane.w));
    if (distance + reach < -rounding) return false;
  }
  return true;
}
