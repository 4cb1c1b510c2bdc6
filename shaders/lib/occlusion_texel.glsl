#pragma once
// Of a texel's pixels, the first that a surface covers: its point. Needs lib/occlusion_points.glsl and pc.points.
float texel_point(ivec2 texel) {
  for (int i = 0; i < TEXEL_PX * TEXEL_PX; ++i) {
    const ivec2 pixel = TEXEL_PX * texel + ivec2(i % TEXEL_PX, i / TEXEL_PX);
    if (any(greaterThanEqual(uvec2(pixel), frame.size_px))) continue;
    const float z = texelFetch(pass_images[pc.points], pixel, 0).r;
    const uint name = uint(i * SAMPLES) + (floatBitsToUint(z) & occlusion_name_mask(PIXELS));
    const float point = occlusion_named(z, name, SHAPE);
    if (point > 0.0) return point;
  }
  return 0.0;
}
