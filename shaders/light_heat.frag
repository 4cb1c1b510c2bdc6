#version 460
// How the light lists fare at the nearest opaque or masked surface: every light against the point's own list, walked
// beside.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/brdf.glsl"
#include "lib/light_eval.glsl"
#include "lib/light_cells.glsl"
#include "lib/light_list.glsl"
#include "lib/draw.frag.glsl"

layout(location = 0) out float out_listed;  // lights of the list
layout(location = 1) out float out_waste;   // of them, those that give exactly nothing here
layout(location = 2) out float out_missed;  // lights that give something and are not listed

void main() {
  const Material m = load_material(in_ids.x);
  const Varyings v = load_varyings();
  if (IS_MASKED != 0 && surface_coverage(m, surface_base_color(m, v).a) == 0.0) discard;
  float listed = 0.0, waste = 0.0, missed = 0.0;
  if (HAS_LIGHTS != 0 && (m.flags & material_unlit) == 0u) {
    LightWalk own = begin_lights(v.relative_position);
    for (uint i = 0u; i < frame.light_count; ++i) {
      const bool is_listed = list_holds(own, i);
      vec3 l;
      const bool gives = light_arriving(light_at(pc.lights, i), v.relative_position, l) != 0.0;
      listed += is_listed ? 1.0 : 0.0;
      waste += is_listed && !gives ? 1.0 : 0.0;
      missed += gives && !is_listed ? 1.0 : 0.0;
    }
  }
  out_listed = listed;
  out_waste = waste;
  out_missed = missed;
}
