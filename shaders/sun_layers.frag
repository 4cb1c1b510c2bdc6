#version 460
// How much of the directional lights' light arrives at the nearest opaque or masked surface, and which cascade tells
// it.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/brdf.glsl"
#include "lib/light_eval.glsl"
#include "lib/light_shadow.glsl"
#include "lib/draw.frag.glsl"

layout(location = 0) out float out_visibility;
layout(location = 1) out float out_cascade;  // of the brightest light; 1 is the finest, 0 none

void main() {
  const Material m = load_material(in_ids.x);
  const Varyings v = load_varyings();
  const vec3 to_viewer = direction_to_viewer();
  vec3 plane_normal = triangle_normal(in_plane_position, to_viewer), surface_point = v.relative_position;
  round_off(plane_normal, surface_point);
  const Surface s = load_surface(m, v, gl_FrontFacing ? 1.0 : -1.0, to_viewer);
  if (IS_MASKED != 0 && surface_coverage(m, s.alpha) == 0.0) discard;
  begin_rays(surface_point, plane_normal);
  out_visibility = 1.0;
  out_cascade = 0.0;
  if (HAS_SUN_SHADOWS != 0 && (m.flags & material_unlit) == 0u) {
    float all = 0.0, arriving = 0.0;
    for (uint i = 0u; i < frame.light_count; ++i) {
      LightRef light = light_at(pc.lights, i);
      if (floatBitsToUint(light_word(light, 3u).y) != light_directional) continue;
      vec3 l;
      light_arriving(light, v.relative_position, l);
      const float weight = dot(light_intensity(light), vec3(0.2126, 0.7152, 0.0722)) * max(dot(s.normal, l), 0.0);
      if (!(weight > 0.0)) continue;
      all += weight;
      arriving += weight * light_visibility(light, i, surface_point, plane_normal);
    }
    if (all > 0.0) out_visibility = arriving == all ? 1.0 : arriving / all;  // a device may round x / x
    if (SUNS_TRACED) return;
    const uint cascade = find_cascade(0u, v.relative_position).number;
    out_cascade = cascade == max_sun_cascades ? 0.0 : float(cascade + 1u);
  }
}
