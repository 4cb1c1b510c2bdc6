#version 460
// Only for masked materials: drops the fragments that the mask cuts away.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#ifdef BY_SAMPLE  // samples of a pixel
#include "lib/sample_places.glsl"
#endif

layout(location = 0) in flat uint in_material;
layout(location = 1) centroid in vec2 in_uv0;
layout(location = 2) centroid in vec2 in_uv1;
layout(location = 3) centroid in vec4 in_color;

void main() {
  Varyings v;
  v.uv0 = in_uv0;
  v.uv1 = in_uv1;
  v.color = in_color;
  const Material m = load_material(in_material);
  const float alpha = surface_base_color(m, v).a;
#ifdef BY_SAMPLE
  const vec2 slope = vec2(dFdx(alpha), dFdy(alpha));
  int kept = 0;
  for (int i = 0; i < BY_SAMPLE; ++i)
    if (alpha + dot(slope, sample_place_px(BY_SAMPLE, uint(i)) - 0.5) >= m.alpha_cutoff) kept |= 1 << i;
  if (kept == 0) discard;
  gl_SampleMask[0] = kept;
#else
  if (alpha < m.alpha_cutoff) discard;
#endif
}
