#pragma once
// The triangles that the keys of a pixel's samples name (shared/visibility.h), each once. Needs lib/frame.glsl,
// lib/sample_places.glsl, pc.table, the address of the keys, and SAMPLES.
uint keyed[SAMPLES];  // 1 + the triangle's number; 0: none
uint keyed_left;      // samples whose triangles have not been taken

void begin_keyed(uvec2 pixel) {
  const uint first = (pixel.y * frame.size_px.x + pixel.x) * uint(SAMPLES);
  keyed_left = 0u;
  for (int s = 0; s < SAMPLES; ++s) {
    keyed[s] = uint(KeysRef(pc.table).k[first + uint(s)]);
    if (keyed[s] != 0u) keyed_left |= 1u << s;
  }
}
// covered: its samples; place: their middle, in the pixel, or the pixel's where it has all. Its number.
uint take_triangle(out uint covered, out vec2 place) {
  const uint triangle = keyed[findLSB(keyed_left)];
  covered = 0u;
  place = vec2(0.0);
  for (int s = 0; s < SAMPLES; ++s)
    if (keyed[s] == triangle) {
      covered |= 1u << s;
      place += sample_place_px(SAMPLES, uint(s));
    }
  keyed_left &= ~covered;
  place = covered == (1u << SAMPLES) - 1u ? vec2(0.5) : place / float(bitCount(covered));
  return triangle - 1u;
}
