#version 460
// The back faces of bodies that let light through: their outward normals in view space, and how far off they are.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/brdf.glsl"
#include "lib/ambient.glsl"
#include "lib/draw.frag.glsl"
#include "lib/glass.glsl"
#include "lib/glass_sums.glsl"

layout(location = 0) out vec4 out_back;

void main() {
  const Material m = MaterialsRef(frame.materials).m[in_ids.x];
  if (!(load_glass(in_ids.x).thickness_m > 0.0)) discard;
  const Varyings v = load_varyings();
  out_back = vec4(in_view(surface_normal(m, v, 1.0, -direction_to_viewer())), in_view(v.relative_position).z);
}
