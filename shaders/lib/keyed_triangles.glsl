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

// What a keyed triangle, or the relief below it, has where the ray of a place meets it. Needs what lib/triangle.glsl
// needs besides.
struct KeyedPoint {
  TriangleBatch batch;
  Item item;
  Geometry geometry;
  Corners corners;
  Material material;
  ViewRay ray;
  TrianglePoint at;
#ifdef RELIEFS
  bool on_relief;
  ReliefPoint relief;
#endif
};
// place: in the pixel, as take_triangle() gives it.
KeyedPoint keyed_point(uint triangle, vec2 place, uvec2 pixel, uint covered) {
  KeyedPoint k;
  k.batch = BatchesRef(frame.batches).b[triangle / triangle_batch_size];
  k.item = load_item(k.batch.item);
  k.geometry = load_geometry(k.item.geometry);
  k.corners = load_corners(frame.indices, k.item, k.geometry,
      k.batch.first_triangle + triangle % triangle_batch_size);
  k.material = load_material(k.item.material);
#ifdef RELIEFS
  k.on_relief = meet_keyed_relief(k.batch.flags, k.item, k.geometry, k.corners, k.material, vec2(pixel) + place, pixel,
      covered, k.ray, k.at, k.relief);
#else
  k.ray = view_ray(vec2(pixel) + place);
  k.at = meet_triangle(k.corners, k.ray);
#endif
  return k;
}
Varyings keyed_varyings(KeyedPoint k) {
#ifdef RELIEFS
  if (k.on_relief) return relief_varyings(k.item, k.geometry, k.corners, k.at, k.relief);
#endif
  return lit_varyings(k.item, k.geometry, k.corners, k.at);
}
bool is_counter_clockwise(KeyedPoint k) { return dot(k.at.plane, k.ray.direction) < 0.0; }
bool is_front(KeyedPoint k) { return is_counter_clockwise(k) != ((k.batch.flags & batch_mirrored) != 0u); }
// The triangle's own normal, or the relief's, on the viewer's side. to_viewer: in the place of one without direction.
vec3 keyed_plane_normal(KeyedPoint k, vec3 to_viewer) {
#ifdef RELIEFS
  if (k.on_relief) return is_front(k) ? k.relief.front : -k.relief.front;
#endif
  return normalize_or(is_counter_clockwise(k) ? k.at.plane : -k.at.plane, to_viewer);
}
vec3 keyed_direction_to_viewer() {
  return frame.perspective != 0u ? normalize(-view_ray(pixel_middle).direction) : frame.camera_back;
}
