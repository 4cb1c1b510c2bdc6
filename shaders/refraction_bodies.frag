#version 460
// Faces of bodies that let light through, before what is opaque: sums over all of a pixel, back faces less front faces,
// of absorbance to the camera and of 1; with NEAREST one over the depth of the nearest (lib/glass_way.glsl).
#include "shared/draw.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/draw.frag.glsl"
#include "lib/bend.glsl"
#include "lib/image_kinds.glsl"
#include "shared/refraction.h"
#ifndef REFRACTION
#define REFRACTION 2
#endif
uint refraction_image(uint place) { return REFRACTION_PLACE(uint(pc.table), place); }
#include "lib/seen_picture.glsl"

#ifdef NEAREST
layout(location = 0) out float out_nearest;
#else
layout(location = 0) out vec4 out_sum;
#endif

void main() {
  const Glass glass = load_glass(in_ids.x);
  const float depth_m = -dot(in_position, frame.camera_back);
  if (!gl_FrontFacing || !(glass.thickness_m > 0.0) || !(depth_m > 0.0)) discard;
  if (refraction_depth_m(ivec2(gl_FragCoord.xy)) < depth_m) discard;
#ifdef NEAREST
  out_nearest = 1.0 / depth_m;
#else
  out_sum = (pc.own != 0u ? 1.0 : -1.0) * vec4(min(glass.absorption, vec3(1e6)) * depth_m, 1.0);
#endif
}
