// Depth samples and what they mean. Needs lib/frame.glsl, the constant SHAPE and pc.depth.
const int SAMPLES = OCCLUSION_SAMPLES(SHAPE), TEXEL_PX = OCCLUSION_TEXEL_PX(SHAPE);
const int PIXELS = 1 | SAMPLES << 8;  // the shape of a point for each pixel

#include "lib/frame_depth.glsl"

float sample_depth(ivec2 p, int s) {
  return frame_depth(p, s, SAMPLES);
}
// 0 outside the picture.
float depth_beside(ivec2 p, int s) {
  if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, ivec2(frame.size_px)))) return 0.0;
  return sample_depth(p, s);
}
// Metres in front of the camera. Perspective: depth = near/z. Orthographic: depth = z_scale * -z_view + z_bias.
float depth_m(float d) {
  const mat4 m = frame.clip_from_relative;
  if (frame.perspective != 0u) return m[3][2] / d;
  const vec3 row = vec3(m[0][2], m[1][2], m[2][2]);
  return max((m[3][2] - d) / length(row), 1e-30);
}
