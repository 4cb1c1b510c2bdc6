#version 460
// KHR_materials_unlit: base colour goes out as radiance.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/draw.frag.glsl"
#ifdef FOG
#include "lib/fog.glsl"
#endif

layout(location = 0) out vec4 out_radiance;  // premultiplied, pre-exposed

void main() {
  const Material m = MaterialsRef(frame.materials).m[in_ids.x];
  const vec4 base = surface_base_color(m, load_varyings());
  const float coverage = IS_MASKED != 0 ? 1.0 : surface_coverage(m, base.a);  // the pre-pass cut: shade_forward.frag
#ifdef FOG
  const FogSeen fog = fog_before(load_varyings().relative_position);
  out_radiance = vec4((max(base.rgb, vec3(0.0)) * frame.pre_exposure * fog.through + fog.light) * coverage, coverage);
#else
  out_radiance = vec4(max(base.rgb, vec3(0.0)) * frame.pre_exposure * coverage, coverage);
#endif
}
