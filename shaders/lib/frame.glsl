// The frame's constants, as `frame`. A block of uniforms: llvmpipe loads it once for all lanes, where it gathers
// storage buffers lane by lane, and GPUs keep it in a cache of its own.
#include "shared/scene.h"
layout(set = 1, binding = 2, scalar) uniform FrameBlock { FrameConstants frame; };

// A direction in the sky's own axes.
// Whether bright spots of the sky are lights of their own.
bool sky_has_lights() { return frame.image_light.light_count != 0u; }
vec3 from_sky(vec3 d) {
  const vec2 turn = frame.sky_turn;
  return vec3(turn.x * d.x + turn.y * d.z, d.y, turn.x * d.z - turn.y * d.x);
}
vec3 in_sky(vec3 d) {
  const vec2 turn = frame.sky_turn;
  return vec3(turn.x * d.x - turn.y * d.z, d.y, turn.y * d.x + turn.x * d.z);
}
