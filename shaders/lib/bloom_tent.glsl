#pragma once
// A level of bloom at four texels of the next finer one, twice as large: a 3x3 tent of bilinear taps (Jimenez 2014), as
// the sum of 4x4 texels that it is. Clamped to the edge. The texels at 2 q - 1 and 2 q, along both axes, share these
// 4x4, so that each is fetched once. sums[i]: at 2 q - 1 + (i & 1, i >> 1).
void bloom_tents(uint coarse, ivec2 q, out vec3 sums[4]) {
  const ivec2 last = textureSize(pass_images[coarse], 0) - 1;
  // Weights of the texels along an axis, for a place a quarter of a texel after one, and turned round before one.
  const float along[4] = float[4](3.0 / 16.0, 7.0 / 16.0, 5.0 / 16.0, 1.0 / 16.0);
  precise vec3 sum[4] = vec3[4](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      const vec3 c = texelFetch(pass_images[coarse], clamp(q - 2 + ivec2(x, y), ivec2(0), last), 0).rgb;
      // Weighed before it is added: sums of the brightest lie beyond floats.
      sum[0] += along[x] * along[y] * c;
      sum[1] += along[3 - x] * along[y] * c;
      sum[2] += along[x] * along[3 - y] * c;
      sum[3] += along[3 - x] * along[3 - y] * c;
    }
  sums = sum;
}
