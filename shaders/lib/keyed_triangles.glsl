#pragma once
// The triangles that the keys of a pixel's samples name (shared/visibility.h), each once. Needs lib/frame.glsl,
// lib/sample_places.glsl, pc.table, the address of the keys, and SAMPLES.
struct KeyedPixel {
  uint seen[SAMPLES];  // 1 + the triangle's number; 0: none
  uint left;           // samples whose triangles have not been taken
};
KeyedPixel keyed_pixel(uvec2 pixel) {
  KeyedPixel p;
  const uint first = (pixel.y * frame.size_px.x + pixel.x) * uint(SAMPLES);
  p.left = 0u;
  for (int s = 0; s < SAMPLES; ++s) {
    p.seen[s] = uint(KeysRef(pc.table).k[first + uint(s)]);
    if (p.seen[s] != 0u) p.left |= 1u << s;
  }
  return p;
}
// covered: its samples; place: their middle, in the pixel, or the pixel's where it has all. Its number.
uint take_triangle(inout KeyedPixel p, out uint covered, out vec2 place) {
  const uint triangle = p.seen[findLSB(p.left)];
  covered = 0u;
  place = vec2(0.0);
  for (int s = 0; s < SAMPLES; ++s)
    if (p.seen[s] == triangle) {
      covered |= 1u << s;
      place += sample_place_px(SAMPLES, uint(s));
    }
  p.left &= ~covered;
  place = covered == (1u << SAMPLES) - 1u ? vec2(0.5) : place / float(bitCount(covered));
  return triangle - 1u;
}
