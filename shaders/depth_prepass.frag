#version 460
// Only for masked materials: drops the fragments that the mask cuts away.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"

layout(location = 0) in flat uint in_material;
layout(location = 1) centroid in vec2 in_uv0;
layout(location = 2) centroid in vec2 in_uv1;
layout(location = 3) centroid in vec4 in_color;

void main() {
  Varyings v;
  const Material m = load_material(in_material);
#ifdef BY_SAMPLE  // samples of a pixel
  int kept = 0;
  for (int i = 0; i < BY_SAMPLE; ++i) {
    v.uv0 = interpolateAtSample(in_uv0, i);
    v.uv1 = interpolateAtSample(in_uv1, i);
    v.color = interpolateAtSample(in_color, i);
    if (surface_base_color(m, v).a >= m.alpha_cutoff) kept |= 1 << i;
  }
  if (kept == 0) discard;
  gl_SampleMask[0] = kept;
#else
  v.uv0 = in_uv0;
  v.uv1 = in_uv1;
  v.color = in_color;
  if (surface_base_color(m, v).a < m.alpha_cutoff) discard;
#endif
}
