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
  v.uv0 = in_uv0;
  v.uv1 = in_uv1;
  v.color = in_color;
  const Material m = load_material(in_material);
  if (surface_base_color(m, v).a < m.alpha_cutoff) discard;
}
