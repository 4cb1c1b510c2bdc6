#version 460
// What the shading of the nearest surface takes, into the G-buffer. LOBES_APART: its lobes alone. RELIEF_BESIDE,
// RELIEF_APART: the triangle of a relief too, or alone (lib/gbuffer_relief.glsl).
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/draw.frag.glsl"
#include "lib/covered.glsl"
#include "lib/plane.glsl"
#include "lib/gbuffer.glsl"
#ifdef RELIEF_APART
layout(location = 0) out uvec4 out_texels[1];
#elif defined(LOBES_APART)
layout(location = 0) out uvec4 out_texels[gbuffer_lobe_texels];
#else
layout(location = 0) out uvec4 out_texels[GBUFFER];
#endif
#ifdef RELIEF_BESIDE
layout(location = GBUFFER) out uvec4 out_relief;
#endif
#if defined(RELIEF) && (defined(RELIEF_APART) || defined(RELIEF_BESIDE))
uvec4 relief_texel() {
  return relief_point.back ? uvec4(0u)
      : uvec4(in_item + 1u, uint(gl_PrimitiveID), floatBitsToUint(relief_point.lod), 0u);
}
#endif

void main() {
  if (!is_any_covered()) return;
  const Material m = load_material(in_ids.x);
  const Varyings v = load_varyings();
#ifdef RELIEF_APART
  out_texels[0] = relief_texel();
#else
#ifdef RELIEF_BESIDE
#ifdef RELIEF
  out_relief = relief_texel();
#else
  out_relief = uvec4(0u);
#endif
#endif
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
#endif
}
