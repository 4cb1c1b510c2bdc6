#version 460
// What reflections need to know of the nearest opaque or masked surface at the pixel's middle, drawn again.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/brdf.glsl"
#include "lib/light_eval.glsl"
#include "lib/light_shadow.glsl"
#include "lib/light_cells.glsl"
#include "lib/light_list.glsl"
#include "lib/ambient.glsl"
#include "lib/occlusion.glsl"
#include "lib/draw.frag.glsl"
#ifdef FOG
#include "lib/fog.glsl"
#include "lib/fog_lamps.glsl"
layout(location = 3) out vec4 out_fog;
#endif
#include "lib/reflections_surface.glsl"

layout(location = 0) out uvec4 out_surface;
layout(location = 1) out uvec2 out_reflectance;
layout(location = 2) out vec4 out_sky;

void main() {
  const Material m = load_material(in_ids.x);
  const Varyings v = load_varyings();
  const vec3 to_viewer = direction_to_viewer();
  // One sample: the position is of the pixel's middle.
  const vec3 plane_normal = triangle_normal(v.relative_position, to_viewer);
  const Surface s = load_surface(m, v, gl_FrontFacing ? 1.0 : -1.0, to_viewer);
  if (IS_MASKED != 0 && surface_coverage(m, s.alpha) == 0.0) discard;
  vec3 rounded_normal = plane_normal, rounded_point = v.relative_position;
  round_off(rounded_normal, rounded_point);
  const ReflectingTexel texel = reflecting_texel(s, IS_UNLIT != 0, v.relative_position, plane_normal, rounded_point,
      rounded_normal, to_viewer);
  out_surface = texel.surface;
  out_reflectance = texel.reflectance;
  out_sky = texel.sky;
#ifdef FOG
  out_fog = texel.fog;
#endif
}
