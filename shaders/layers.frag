#version 460
// Layers beside beauty, at pixel centres, one sample: an averaged id or depth would name a surface that does not exist.
// The nearest opaque or masked surface counts.
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
#include "lib/draw.frag.glsl"

// Each wanted layer is defined as its attachment's number; an unwanted one has no output.
#ifdef DEPTH
layout(location = DEPTH) out float out_depth_m;
#endif
#ifdef NORMAL
layout(location = NORMAL) out vec4 out_world_normal;
#endif
#ifdef ALBEDO
layout(location = ALBEDO) out vec4 out_albedo;
#endif
#ifdef OBJECT_ID
layout(location = OBJECT_ID) out uint out_object_id;
#endif
#ifdef MATERIAL_ID
layout(location = MATERIAL_ID) out uint out_material_id;
#endif
#ifdef DIRECT
layout(location = DIRECT) out vec4 out_direct;
#endif

void main() {
  const Material m = load_material(in_ids.x);
  const Varyings v = load_varyings();
  const vec3 to_viewer = direction_to_viewer();
#ifdef DIRECT
  vec3 plane_normal = HAS_SHADOWS ? triangle_normal(in_plane_position, to_viewer) : vec3(0.0);
  vec3 surface_point = v.relative_position;
  round_off(plane_normal, surface_point);
#endif
  const bool unlit = (m.flags & material_unlit) != 0u;
  const Surface s = load_surface(m, v, gl_FrontFacing ? 1.0 : -1.0, to_viewer);
  if (IS_MASKED != 0 && surface_coverage(m, s.alpha) == 0.0) discard;
#ifdef DEPTH
  out_depth_m = -dot(v.relative_position, frame.camera_back);
#endif
#ifdef NORMAL
  out_world_normal = vec4(unlit || IS_UNLIT != 0 ? vec3(0.0) : s.normal, 1.0);
#endif
#ifdef ALBEDO
  out_albedo = vec4(s.base_color, 1.0);
#endif
#ifdef OBJECT_ID
  out_object_id = in_ids.y;
#endif
#ifdef MATERIAL_ID
  out_material_id = m.id;
#endif
#ifdef DIRECT
  begin_rays(surface_point, plane_normal);
  precise vec3 direct = vec3(0.0);
  if (HAS_LIGHTS != 0 && !unlit) {
    const BrdfTerms brdf = brdf_terms(s, to_viewer);
    for (LightWalk w = begin_lights(v.relative_position); next_light(w);) {
      LightRef light = light_at(pc.lights, w.light);
      vec3 reaching = light_reaching(light, w.light, brdf, v.relative_position, surface_point, plane_normal);
      direct += reaching;
    }
  }
  out_direct = vec4(direct * frame.pre_exposure, 1.0);
#endif
}
