#pragma once
// What is blended behind surfaces that let light through: of a fragment's samples those that lie behind the depth of
// the image that pc.table names. BEHIND is that image's samples a pixel. Needs lib/bindless.glsl.
#include "lib/occlusion_points.glsl"

// Without discarding: neighbours still want this fragment's derivatives.
void keep_behind() {
  const vec2 slope = vec2(dFdx(gl_FragCoord.z), dFdy(gl_FragCoord.z));
  const ivec2 pixel = ivec2(gl_FragCoord.xy);
  int left = gl_SampleMaskIn[0];
#if BEHIND > 1
  for (int i = 0; i < BEHIND; ++i) {
    const float there = texelFetch(pass_multisampled_images[uint(pc.table)], pixel, i).r;
    const float z = gl_FragCoord.z + dot(slope, sample_place_px(BEHIND, uint(i)) - 0.5);
    if (!(z < there)) left &= ~(1 << i);
  }
#else
  if (!(gl_FragCoord.z < texelFetch(pass_images[uint(pc.table)], pixel, 0).r)) left = 0;
#endif
  gl_SampleMask[0] = left;
}
