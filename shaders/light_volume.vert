#version 460
// A light's volume, or, of those that reach everywhere, the whole picture. Instances follow the lights of the list.
// ORDERED: the list is of all kinds, and triangles of volumes that the camera is inside of are turned, so that those
// which are drawn face the camera.
#include "shared/draw.h"
#include "shared/light_volumes.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/frame.glsl"
#include "lib/light_data.glsl"
#include "lib/light_volume.glsl"
#ifndef LIST  // which of the lists of volumes
#define LIST 0
#endif
layout(location = 0) out flat uint out_light;

void main() {
  const uint number = VolumeWordsRef(pc.deformed_before).w[LIST * frame.light_count + uint(gl_InstanceIndex)];
  out_light = number;
  LightRef light = light_at(pc.lights, number);
  uint vertex = uint(gl_VertexIndex);
#ifdef ORDERED
  const uint kind = volume_list(light);
  if (kind == volumes_inside && vertex % 3u != 0u) vertex += vertex % 3u == 1u ? 1u : -1u;
#else
  const uint kind = LIST;
#endif
  if (kind == volumes_everywhere) {
    gl_Position = vec4(vertex == 1u ? 3.0 : -1.0, vertex == 2u ? -3.0 : 1.0, 0.0, 1.0);
    if (vertex > 2u) gl_Position = vec4(0.0, 0.0, 0.0, 1.0);  // nothing
    return;
  }
  const vec3 corner = volume_corner(light_volume(light, light_word(light, 1u).y), vertex);
  gl_Position = frame.clip_from_relative * vec4(corner, 1.0);
  if (pc.subsample_ndc != vec2(0.0)) gl_Position.xy -= pc.subsample_ndc * gl_Position.w;
  // Behind the far plane of a camera that has one nothing is clipped.
  if (kind == volumes_inside && frame.perspective == 0u) gl_Position.z = 0.0;
}
