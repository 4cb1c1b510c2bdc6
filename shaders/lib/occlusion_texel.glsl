#pragma once
// Of a texel's pixels, the first that a surface covers: its point. Needs lib/occlusion_points.glsl and
// lib/occlusion_depth.glsl.
ivec2 texel_pixel(ivec2 texel, int i) { return TEXEL_PX * texel + ivec2(i % TEXEL_PX, i / TEXEL_PX); }
// Named as the texel's, of the point of its pixel number i.
float point_of_texel(float pixel_point, int i) {
  const uint name = uint(i * SAMPLES) + (floatBitsToUint(pixel_point) & occlusion_name_mask(PIXELS));
  return occlusion_named(pixel_point, name, SHAPE);
}
