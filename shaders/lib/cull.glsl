// Tests of one item's box against a view. Written so that NaN and infinite bounds are kept, and
// rounding never culls.
#extension GL_EXT_control_flow_attributes : require
#include "lib/frame.glsl"
#include "shared/cull.h"
layout(push_constant, scalar) uniform Push { CullPush pc; };
layout(local_size_x = 256) in;
// 0: the camera alone, whose planes are in the frame's constants; 1: a range of the table of views.
layout(constant_id = 0) const int HAS_VIEW_TABLE = 0;
// 1: some views leave out what moves, others all else.
layout(constant_id = 1) const int TELLS_MOVING = 0;

// The workgroup's place among all groups of all views of the range.
uint flat_group() { return gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x; }

bool is_outside(vec4 plane, Item item) {
  const float reach = dot(abs(plane.xyz), item.bounds_extent);
  const float distance = dot(plane.xyz, item.bounds_centre) + plane.w;
  const float rounding = 4.0 * 1.1920929e-7 * (dot(abs(plane.xyz), abs(item.bounds_centre)) + reach + abs(plane.w));
  return distance + reach < -rounding;
}
bool is_inside(vec4 plane, Item item) {
  const float reach = dot(abs(plane.xyz), item.bounds_extent);
  const float distance = dot(plane.xyz, item.bounds_centre) + plane.w;
  const float rounding = 4.0 * 1.1920929e-7 * (dot(abs(plane.xyz), abs(item.bounds_centre)) + reach + abs(plane.w));
  return distance - reach > rounding;
}

bool camera_keeps(Item item) {
  [[dont_unroll]] for (int p = 0; p < 5; ++p)
    if (is_outside(frame.planes[p], item)) return false;
  return true;
}

bool view_keeps(uint view, Item item) {
  ViewsRef views = ViewsRef(pc.views);
  for (int p = 0; p < 6; ++p)
    if (is_outside(views.v[view].planes[p], item)) return false;
  if ((views.v[view].flags & view_has_served) != 0u) {
    bool served = true;
    for (int p = 0; p < 4; ++p) served = served && is_inside(views.v[view].served[p], item);
    if (served) return false;
  }
  return true;
}

// Whether it is large enough in the view (View::least_px): an approximation, which holds with culling or without.
bool is_shown(uint view, Item item) {
  ViewsRef views = ViewsRef(pc.views);
  const float least_px = views.v[view].least_px;
  if (least_px > 0.0) {
    // Clip space is 2 wide, so half a box in clip units is its whole width in units of the viewport's.
    const mat4 m = views.v[view].clip_from_relative;
    const vec2 half_clip = vec2(dot(abs(vec3(m[0].x, m[1].x, m[2].x)), item.bounds_extent),
                                dot(abs(vec3(m[0].y, m[1].y, m[2].y)), item.bounds_extent));
    const vec2 extent_px = half_clip * vec2(views.v[view].size_px);
    if (extent_px.x < least_px && extent_px.y < least_px) return false;
  }
  return true;
}

bool view_skips(uint view, Item item) {
  const bool moves = (MasksRef(pc.moving).m[item.object_id / 32u] >> (item.object_id & 31u) & 1u) != 0u;
  return (ViewsRef(pc.views).v[view].flags & (moves ? view_skips_moving : view_skips_standing)) != 0u;
}

bool item_survives(uint view, uint index) {
  const Item item = ItemsRef(frame.items).i[index];
  if (TELLS_MOVING != 0 && view_skips(view, item)) return false;
  if (HAS_VIEW_TABLE != 0 && (ViewsRef(pc.views).v[view].flags & view_of_lamp) != 0u) {
    MaterialsRef materials = MaterialsRef(frame.materials);
    const uint texture = materials.m[item.material].emissive_texture.texture;
    if (materials.m[item.material].emissive != vec3(0.0) && texture == absent) return false;
  }
  if (HAS_VIEW_TABLE != 0 && !is_shown(view, item)) return false;
  if (pc.culling == 0u) return true;
  return HAS_VIEW_TABLE != 0 ? view_keeps(view, item) : camera_keeps(item);
}
