#version 460
// KHR_materials_unlit: base colour goes out as radiance.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/draw.frag.glsl"
#include "lib/blended.glsl"
#include "lib/covered.glsl"
#ifdef FOG
#include "lib/fog.glsl"
#endif
#if defined(BEHIND) || defined(BEFORE)
#include "lib/behind.glsl"
#endif

void main() {
#if defined(BEHIND) || defined(BEFORE)
  keep_part();
#endif
  if (!is_any_covered() || !is_put_out()) return;
  const Material m = load_material(in_ids.x);
  const Varyings v = load_varyings();
  const vec4 base = surface_base_color(m, v);
  const float coverage = IS_MASKED != 0 ? 1.0 : surface_coverage(m, base.a);  // the pre-pass cut: shade_forward.frag
#ifdef FOG
  const FogSeen fog = fog_before(v.relative_position);
  const vec3 radiance = max(base.rgb, vec3(0.0)) * frame.pre_exposure * fog.through + fog.light;
  put_out(vec4(radiance * coverage, coverage), v.relative_position);
#else
  put_out(vec4(max(base.rgb, vec3(0.0)) * frame.pre_exposure * coverage, coverage), v.relative_position);
#endif
}
