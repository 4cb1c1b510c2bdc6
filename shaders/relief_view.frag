#version 460
// Depth of reliefs as a view sees them that is not the camera's (depth_view.vert).
#define TRIANGLES
#ifndef RELIEF  // defined wherever it is used, to what lib/relief_fragment.glsl says
#define RELIEFS 1
#define RELIEF 1
#endif
#include "shared/draw.h"
#ifdef LAMPS
layout(push_constant, scalar) uniform Push { DepthLampPush pc; };
#else
layout(push_constant, scalar) uniform Push { DepthViewPush pc; };
#endif
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/vertex_position.glsl"
#include "lib/material.glsl"
#include "lib/relief.glsl"
#include "lib/relief_view.glsl"
layout(location = 0) in flat uint in_item;
layout(location = 4) in vec3 in_position;

void main() {
  const Item item = load_item(in_item);
  const Geometry g = load_geometry(item.geometry);
  WordsRef words = WordsRef(frame.indices);
  const uint first = item.first_index + 3u * uint(gl_PrimitiveID);
  const uvec3 v = uvec3(words.w[first], words.w[first + 1u], words.w[first + 2u]);
  vec3 p[3];
  for (int i = 0; i < 3; ++i)
#ifdef LAMPS
    p[i] = position_about(pc.origin, pc.origin_rest, item, g, v[i]);
#else
    p[i] = relative_position(item, g, v[i]);
#endif
  const Relief r = triangle_relief(item, g, v, p, load_material(item.material));
#ifdef LAMPS
  const vec3 direction = in_position;
#else
  const vec3 direction = relief_view_direction(pc.clip_from_relative, in_position);
#endif
  vec3 position;
  if (!meet_relief_view(r, in_position, direction, position)) discard;
#ifdef LAMPS
  const vec4 clip = lamp_clip(pc.clip_from_relative, position);
#else
  const vec4 clip = pc.clip_from_relative * vec4(position, 1.0);
#endif
  gl_FragDepth = clamp(clip.z / clip.w, 0.0, 1.0);
}
