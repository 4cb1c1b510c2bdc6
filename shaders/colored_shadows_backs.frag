#version 460
// The sides of bodies of glass that look away from a light: where they are, and their outward normals, in relative
// space.
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { ColoredShadowPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/draw.frag.glsl"
#include "lib/bend.glsl"
#include "lib/colored_shadows.glsl"

layout(location = 0) out vec4 out_position;
layout(location = 1) out vec4 out_normal;

void main() {
  const Varyings v = load_varyings();
  const vec3 to_light = direction_to_light(v.relative_position);
  const vec3 normal = surface_normal(load_material(in_ids.x), v, 1.0, -to_light);
  if (!(load_glass(in_ids.x).thickness_m > 0.0) || !(dot(normal, to_light) < 0.0)) discard;
  out_position = vec4(v.relative_position, 1.0);
  out_normal = vec4(normal, 0.0);
}
