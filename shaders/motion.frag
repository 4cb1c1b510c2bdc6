#version 460
// How far the point of the surface has moved in the picture, in pixels, y up.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/draw.frag.glsl"

layout(location = 8) in vec3 in_now;     // clip space without its depth
layout(location = 9) in vec3 in_before;  // the same of the time before

layout(location = 0) out vec2 out_motion_px;

void main() {
  const Material m = load_material(in_ids.x);
  if (IS_MASKED != 0 && surface_coverage(m, surface_base_color(m, load_varyings()).a) == 0.0) discard;
  vec2 moved = vec2(0.0);
  // Behind the camera nothing has a place; beside it the place may be farther than a float reaches.
  if (in_before.z > 0.0) {
    precise vec2 now = in_now.xy / in_now.z;
    precise vec2 before = in_before.xy / in_before.z;
    precise vec2 difference = now - before;
    moved = difference * vec2(0.5, -0.5) * vec2(frame.size_px);
    if (!(abs(moved.x) < 3.4e38 && abs(moved.y) < 3.4e38)) moved = vec2(0.0);
  }
  out_motion_px = moved;
}
