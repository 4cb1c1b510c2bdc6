#pragma once
// What a point of the picture takes of coarse texels about it: bilinear, and less the farther their depth is from its
// own (joint bilateral upsampling; Kopf, Cohen, Lischinski, Uyttendaele, 2007). Texels: radiance, and depth in metres.
const float COARSE_SAME = 0.02;  // of a depth: two texels that differ by this share are half as much of one surface

vec3 coarse_light(uint image, vec2 place_px, uint texel_px, ivec2 texels, float metres, bool aware) {
  const vec2 at = place_px / float(texel_px) - 0.5;
  const ivec2 low = ivec2(floor(at));
  const vec2 s = at - vec2(low);
  vec3 sum = vec3(0.0);
  float all = 0.0;
  for (int i = 0; i < 4; ++i) {
    const ivec2 corner = ivec2(i & 1, i >> 1);
    const vec4 texel = texelFetch(pass_images[image], clamp(low + corner, ivec2(0), texels - 1), 0);
    float weight = (corner.x == 0 ? 1.0 - s.x : s.x) * (corner.y == 0 ? 1.0 - s.y : s.y);
    if (aware) weight *= 1.0 / (1e-3 + abs(texel.a - metres) / max(max(texel.a, metres), 1e-30) * (1.0 / COARSE_SAME));
    sum += texel.rgb * weight;
    all += weight;
  }
  return sum / max(all, 1e-30);
}
