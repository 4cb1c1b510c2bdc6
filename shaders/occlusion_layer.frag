#version 460
// How open the nearest opaque or masked surface is to the sky, as shading reads it.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/plane.glsl"
#include "lib/light_data.glsl"
#include "lib/traced_light.glsl"
#include "lib/occlusion.glsl"
#include "lib/draw.frag.glsl"

layout(location = 0) out float out_open;

void main() {
  const Material m = load_material(in_ids.x);
  const Varyings v = load_varyings();
  const vec3 to_viewer = direction_to_viewer();
  vec3 plane_normal = triangle_normal(in_plane_position, to_viewer);
  vec3 surface_point = onto_triangle(v.relative_position, plane_normal, in_plane_position);
  round_off(plane_normal, surface_point);
  if (IS_MASKED != 0 && surface_base_color(m, v).a < m.alpha_cutoff) discard;
  begin_rays(surface_point, plane_normal);
  out_open = 1.0;
  if (HAS_OCCLUSION != 0 && (m.flags & material_unlit) == 0u)
    out_open = occlusion_open(surface_point, plane_normal).fraction;
}
