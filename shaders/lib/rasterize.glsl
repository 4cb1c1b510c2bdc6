#pragma once
// Triangles in the picture's fixed point, with the rules of the hardware's rasterizer (Vulkan 1.3, 28.12): corners are
// snapped to 1/256 pixel, samples on an edge belong to the triangle whose upper or left edge it is. Edge functions are
// whole numbers, so that neighbours neither overlap nor leave gaps (Pineda, "A Parallel Algorithm for Polygon
// Rasterization", 1988).
const int raster_one = 256;               // pixel
const float raster_guard_px = 8192.0;     // farther from the picture's middle than this, triangles are clipped
const int raster_planes = 7;
const int most_corners = 3 + raster_planes;  // a plane adds one; where rounding would add more, they are left out
uvec2 raster_size_px;                     // of the viewport
ivec2 raster_first_px, raster_end_px;     // pixels of it that are drawn

// A triangle in front of the camera, with positive area where y points down.
struct Piece {
  ivec2 p[3];     // 1/256 pixel
  vec3 depth;     // at the first corner, and its slope by 1/256 pixel
  bool clockwise; // as it is seen
};

vec2 raster_px(vec4 clip) { return (clip.xy / clip.w) * (0.5 * vec2(raster_size_px)) + 0.5 * vec2(raster_size_px); }

// False: it has no area.
bool make_piece(vec4 a, vec4 b, vec4 c, out Piece piece) {
  const ivec2 p0 = ivec2(round(raster_px(a) * float(raster_one)));
  const ivec2 p1 = ivec2(round(raster_px(b) * float(raster_one)));
  const ivec2 p2 = ivec2(round(raster_px(c) * float(raster_one)));
  const i64vec2 e1 = i64vec2(p1 - p0), e2 = i64vec2(p2 - p0);
  const int64_t area = e1.x * e2.y - e1.y * e2.x;
  piece.clockwise = area > 0;
  piece.p[0] = p0;
  piece.p[1] = piece.clockwise ? p1 : p2;
  piece.p[2] = piece.clockwise ? p2 : p1;
  // The two products of a slope nearly cancel in a needle whose far corners lie side by side, but not where the edge
  // between these is one of the factors. The shorter edge from the first corner stays one.
  precise const float z0 = a.z / a.w, z1 = b.z / b.w - z0, z2 = c.z / c.w - z0, z3 = c.z / c.w - b.z / b.w;
  const vec2 f1 = vec2(e1), f2 = vec2(e2), f3 = vec2(p2 - p1);
  precise vec2 slope;
  if (dot(f1, f1) <= dot(f2, f2))
    slope = vec2(z1 * f3.y - z3 * f1.y, z3 * f1.x - z1 * f3.x);
  else
    slope = vec2(z2 * f3.y - z3 * f2.y, z3 * f2.x - z2 * f3.x);
  piece.depth = vec3(z0, slope * (area != 0 ? 1.0 / float(area) : 0.0));
  return area != 0;
}

// How far a corner lies inside of a plane: the near plane, the camera's own, a frame around the picture, the far plane.
float inside_of(vec4 clip, int plane) {
  const vec2 guard = raster_guard_px / (0.5 * vec2(raster_size_px));
  switch (plane) {
    case 0: return clip.w - clip.z;
    case 1: return clip.w - 1e-30;
    case 2: return guard.x * clip.w + clip.x;
    case 3: return guard.x * clip.w - clip.x;
    case 4: return guard.y * clip.w + clip.y;
    case 5: return guard.y * clip.w - clip.y;
    default: return clip.z;
  }
}
bool outside_picture(vec4 a, vec4 b, vec4 c) {
  const vec3 x = vec3(a.x, b.x, c.x), y = vec3(a.y, b.y, c.y), w = vec3(a.w, b.w, c.w), z = vec3(a.z, b.z, c.z);
  return all(lessThan(x, -w)) || all(greaterThan(x, w)) || all(lessThan(y, -w)) || all(greaterThan(y, w)) ||
      all(greaterThan(z, w)) || all(lessThan(z, vec3(0.0))) ||
      !all(lessThan(abs(x) + abs(y) + abs(z) + abs(w), vec3(3e38)));
}
bool needs_clipping(vec4 a, vec4 b, vec4 c) {
  float least = 3e38;
  for (int plane = 0; plane < raster_planes; ++plane)
    least = min(least, min(inside_of(a, plane), min(inside_of(b, plane), inside_of(c, plane))));
  return !(least >= 0.0);
}

// The polygon that is left of the triangle (Sutherland and Hodgman, "Reentrant Polygon Clipping", 1974): how many
// corners it has.
int clip_polygon(vec4 a, vec4 b, vec4 c, out vec4 polygon[most_corners]) {
  vec4 before[most_corners];
  int count = 3;
  polygon[0] = a;
  polygon[1] = b;
  polygon[2] = c;
  for (int plane = 0; plane < raster_planes; ++plane) {
    // Most planes cut nothing.
    float least = 0.0;
    for (int i = 0; i < count; ++i) least = min(least, inside_of(polygon[i], plane));
    if (least >= 0.0) continue;
    for (int i = 0; i < count; ++i) before[i] = polygon[i];
    const int of = count;
    count = 0;
    for (int i = 0; i < of; ++i) {
      const vec4 from = before[i], to = before[i + 1 < of ? i + 1 : 0];
      const float f = inside_of(from, plane), t = inside_of(to, plane);
      if (f >= 0.0 && count < most_corners) polygon[count++] = from;
      // From the same end for both triangles of an edge.
      if ((f >= 0.0) != (t >= 0.0) && count < most_corners)
        polygon[count++] = f >= 0.0 ? mix(from, to, f / (f - t)) : mix(to, from, t / (t - f));
    }
  }
  return count;
}

// Pixels whose samples it may hold; empty: none that is drawn.
struct PixelBounds {
  ivec2 low, high;  // inclusive
};
PixelBounds piece_bounds(Piece t) {
  const ivec2 low = min(t.p[0], min(t.p[1], t.p[2])), high = max(t.p[0], max(t.p[1], t.p[2]));
  return PixelBounds(max(low >> 8, raster_first_px), min(high >> 8, raster_end_px - 1));
}

// In pixels, also of what lies beside the picture.
ivec2 piece_size(Piece t) {
  return ((max(t.p[0], max(t.p[1], t.p[2])) - min(t.p[0], min(t.p[1], t.p[2]))) >> 8) + 1;
}

// E(x, y) = a x + b y + c, above 0 inside and on edges that the triangle owns, x and y in 1/256 pixel from `corner`.
struct Edges {
  ivec3 a, b;
  i64vec3 c;
};
Edges piece_edges(Piece t, ivec2 corner) {
  Edges e;
  for (int i = 0; i < 3; ++i) {
    const ivec2 from = t.p[i] - corner, along = t.p[i < 2 ? i + 1 : 0] - t.p[i];
    e.a[i] = -along.y;
    e.b[i] = along.x;
    const bool owned = along.y < 0 || (along.y == 0 && along.x > 0);
    e.c[i] = int64_t(along.y) * int64_t(from.x) - int64_t(along.x) * int64_t(from.y) + (owned ? 1 : 0);
  }
  return e;
}

// The same for samples of one tile, whose places are whole sixteenths of a pixel from the tile's corner: inside is
// a x + b y > c. An edge is at most two guards long, so that 32 bits do.
struct TileEdges {
  ivec3 a, b, c;
};
TileEdges tile_edges(Piece t, ivec2 corner) {
  const Edges e = piece_edges(t, corner);
  // 16 k + c > 0 for a whole k where k > floor(-c / 16).
  const i64vec3 least = -e.c >> 4;
  return TileEdges(e.a, e.b, ivec3(clamp(least, i64vec3(-0x7fffffffl), i64vec3(0x7fffffffl))));
}
bool inside_tile(TileEdges e, ivec2 p) { return all(greaterThan(e.a * p.x + e.b * p.y, e.c)); }

// Reversed depth at a place from the first corner, above 0: a surface at infinity is before the sky.
uint piece_depth(Piece t, ivec2 place) {
  const vec2 off = vec2(place - t.p[0]);
  return floatBitsToUint(clamp(t.depth.x + off.x * t.depth.y + off.y * t.depth.z, 1e-37, 1.0));
}
