#version 460
// What the shading of the nearest surface takes, into the G-buffer. LOBES_APART: its lobes alone.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/draw.frag.glsl"
#include "lib/covered.glsl"
#include "lib/plane.glsl"
#include "lib/gbuffer.glsl"
#ifdef LOBES_APART
layout(location = 0) out uvec4 out_texels[gbuffer_lobe_texels];
#else
layout(location = 0) out uvec4 out_texels[GBUFFER];
#endif

void main() {
  if (!is_any_covered()) return;
  const Material m = load_material(in_ids.x);
  const Varyings v = load_varyings();
  SurfacePoint p = no_point();
  p.position = p.on_triangle = p.at_middle = v.relative_position;
  p.is_unlit = IS_UNLIT != 0;
  if (IS_UNLIT != 0) {
    p.surface.emission = max(surface_base_color(m, v).rgb, vec3(0.0));
  } else {
    const vec3 to_viewer = direction_to_viewer();
    p.surface = load_surface(m, v, gl_FrontFacing ? 1.0 : -1.0, to_viewer);
    if (HAS_SHADOWS || HAS_OCCLUSION != 0) {
      p.plane_normal = triangle_normal(in_plane_position, to_viewer);
      p.on_triangle = onto_triangle(v.relative_position, p.plane_normal, in_plane_position);
      p.at_middle = in_plane_position;
      round_off(p.plane_normal, p.on_triangle);
    }
  }
#ifdef LOBES_APART
  lobes_to_texels(p.surface.lobes, out_texels);
#else
  out_texels = gbuffer_of(p).texel;
#endif
}
