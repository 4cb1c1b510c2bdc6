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
// covered: its samples; place: their middle, in the pixel, or the pixel's where it has all. Its number. With
// relief.by_sample those of a relief are taken one by one.
uint take_triangle(out uint covered, out vec2 place) {
  const int first = findLSB(keyed_left);
  const uint triangle = keyed[first];
#ifdef RELIEFS
  if (RELIEF_OF_SAMPLES &&
      (BatchesRef(frame.batches).b[(triangle - 1u) / triangle_batch_size].flags & batch_relief) != 0u) {
    covered = 1u << first;
    place = sample_place_px(SAMPLES, uint(first));
    keyed_left &= ~covered;
    return triangle - 1u;
  }
#endif
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
#ifdef RELIEFS
// Where a keyed triangle, or the relief below it, is met: at the middle of its samples, or, where that passes by the
// relief, at the first of them. place: of the middle, in the picture. False: it is the triangle's own plane.
bool meet_keyed_relief(uint batch_flags, Item item, Geometry g, Corners corners, Material m, vec2 place, uvec2 pixel,
                       uint covered, out ViewRay ray, out TrianglePoint p, out ReliefPoint relief) {
  ray = view_ray(place);
  p = meet_triangle(corners, ray);
  if ((batch_flags & batch_relief) == 0u) return false;
  if (meet_relief(item, g, corners, m, ray, p, relief)) return true;
  if (SAMPLES == 1 || RELIEF_OF_SAMPLES) return false;
  ray = view_ray(vec2(pixel) + sample_place_px(SAMPLES, uint(findLSB(covered))));
  p = meet_triangle(corners, ray);
  return meet_relief(item, g, corners, m, ray, p, relief);
}
#endif
