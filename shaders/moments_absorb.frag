#version 460
// What a blended surface absorbs, and that times powers of its depth, to be summed.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/draw.frag.glsl"
#include "lib/moments.glsl"

layout(location = 0) out vec4 out_first;
#if MOMENTS == 4
layout(location = 1) out float out_absorbance;
#else
layout(location = 1) out vec4 out_absorbance;  // and the fifth moment to the seventh
#endif
#if MOMENTS == 8
layout(location = 2) out float out_last;
#endif

void main() {
  const Material m = load_material(in_ids.x);
  const Varyings v = load_varyings();
  const float absorbance = absorbance_of(surface_coverage(m, surface_base_color(m, v).a));
  const float z = warped_depth(v.relative_position), z2 = z * z, z4 = z2 * z2;
  out_first = absorbance * vec4(z, z2, z2 * z, z4);
#if MOMENTS == 4
  out_absorbance = absorbance;
#elif MOMENTS == 6
  out_absorbance = absorbance * vec4(1.0, z4 * z, z4 * z2, 0.0);
#else
  out_absorbance = absorbance * vec4(1.0, z4 * z, z4 * z2, z4 * z2 * z);
  out_last = absorbance * z4 * z4;
#endif
}
