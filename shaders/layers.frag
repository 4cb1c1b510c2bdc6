#version 460
// Layers beside beauty, at pixel centres, one sample: an averaged id or depth would name a surface that does not exist. Which
// outputs are stored is decided by the attachments; the nearest opaque or masked surface counts.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/brdf.glsl"
#include "lib/light_eval.glsl"
#include "lib/draw.frag.glsl"
layout(constant_id = 14) const int WANTS_DIRECT = 0;

layout(location = 0) out float out_depth_m;
layout(location = 1) out vec4 out_world_normal;
layout(location = 2) out vec4 out_albedo;
layout(location = 3) out uint out_object_id;
layout(location = 4) out uint out_material_id;
layout(location = 5) out vec4 out_emission;
layout(location = 6) out vec4 out_direct;

void main() {
  const Material m = MaterialsRef(frame.materials).m[in_ids.x];
  const Varyings v = load_varyings();
  const vec3 to_viewer = direction_to_viewer(v.relative_position);
  const bool unlit = (m.flags & material_unlit) != 0u;
  const Surface s = load_surface(m, v, gl_FrontFacing ? 1.0 : -1.0, to_viewer);
  if (IS_MASKED != 0 && surface_coverage(m, s.alpha) == 0.0) discard;
  out_depth_m = -dot(v.relative_position, frame.camera_back);
  out_world_normal = vec4(s.normal, 1.0);
  out_albedo = vec4(s.base_color, 1.0);
  out_object_id = in_ids.y;
  out_material_id = m.id;
  out_emission = vec4((unlit ? s.base_color : s.emission) * frame.pre_exposure, 1.0);
  precise vec3 direct = vec3(0.0);
  if (WANTS_DIRECT != 0 && HAS_LIGHTS != 0 && !unlit)
    for (uint i = 0u; i < frame.light_count; ++i) direct += light_contribution(i, s, v.relative_position, to_viewer);
  out_direct = vec4(direct * frame.pre_exposure, 1.0);
}
