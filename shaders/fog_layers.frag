#version 460
// Fog before each surface, composited as the surfaces are: the light that it scatters or emits towards the camera, and
// its transmittance. Each wanted one is defined as its attachment's number; with STORED the one that TERM names is
// stored.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/draw.frag.glsl"
#include "lib/fog.glsl"
#include "lib/term_output.glsl"

#ifdef LIGHT
TERM_OUTPUT(LIGHT) vec4 out_light;  // pre-exposed
#endif
#ifdef TRANSMITTANCE
TERM_OUTPUT(TRANSMITTANCE) vec4 out_transmittance;
#endif

void main() {
  if (!is_put_out()) return;
  const Material m = load_material(in_ids.x);
  const float coverage = IS_MASKED != 0 ? 1.0 : surface_coverage(m, surface_base_color(m, load_varyings()).a);
#ifdef LIGHT
  const FogSeen fog = fog_before(load_varyings().relative_position);
  out_light = vec4(fog.light * coverage, coverage);
#endif
#ifdef TRANSMITTANCE
  out_transmittance = vec4(fog_before_through(load_varyings().relative_position) * coverage, coverage);
#endif
#ifdef STORED
  put_out(TERM, load_varyings().relative_position);
#endif
}
