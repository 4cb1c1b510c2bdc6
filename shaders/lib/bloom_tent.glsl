#pragma once
// A level of bloom at a texel of the next finer one, twice as large: a 3x3 tent of bilinear taps (Jimenez 2014), as the
// sum of 4x4 texels that it is. Clamped to the edge.
vec3 bloom_tent(uint coarse, ivec2 p) {
  const ivec2 last = textureSize(pass_images[coarse], 0) - 1, first = (p + 1) / 2 - 2;
  // Weights of the texels along an axis, for a place a quarter of a texel after one, and turned round before one.
  const float along[4] = float[4](3.0 / 16.0, 7.0 / 16.0, 5.0 / 16.0, 1.0 / 16.0);
  const bvec2 is_after = notEqual(p & 1, ivec2(0));
  precise vec3 sum = vec3(0.0);  // weighed before it is added: sums of the brightest lie beyond floats
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      const float w = along[is_after.x ? x : 3 - x] * along[is_after.y ? y : 3 - y];
      sum += w * texelFetch(pass_images[coarse], clamp(first + ivec2(x, y), ivec2(0), last), 0).rgb;
    }
  return sum;
}
