#version 460
// Writes one sample of every pixel with its own colour from a buffer: pixel by pixel, the samples of a pixel together.
#include "shared/types.h"
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Texels { vec4 t[]; };
layout(push_constant, scalar) uniform Push { uint64_t source; uint width, samples, which; } push;
layout(location = 0) out vec4 color;
void main() {
  const uvec2 at = uvec2(gl_FragCoord.xy);
  gl_SampleMask[0] = 1 << push.which;
  color = Texels(push.source).t[(at.y * push.width + at.x) * push.samples + push.which];
}
