#pragma once
// Cells of the light grid (shared/lights.h): where they lie, and which one holds a point. Needs `frame` (lib/scene.glsl
// or a macro). A point chooses its cell by its own position, never by gl_FragCoord: then the list is right for whatever
// position the rasteriser interpolated, however far off the pixel rounding put it.

uint light_slice(float z) {
  // Bits of a positive float grow with it: slices are exponential, linear inside each octave, and exact on every
  // device.
  const int s = int(floatBitsToUint(max(z, 0.0)) >> frame.grid.slice_shift) - frame.grid.slice_base;
  return uint(clamp(s, 0, int(frame.grid.slices) - 1));
}
// Depths of a slice, widened; the first and the last are open.
vec2 light_slice_depths(uint s) {
  const float low = uintBitsToFloat(uint(int(s) + frame.grid.slice_base) << frame.grid.slice_shift);
  const float high = uintBitsToFloat(uint(int(s) + 1 + frame.grid.slice_base) << frame.grid.slice_shift);
  return vec2(s == 0u ? -3.0e38 : low * (1.0 - frame.grid.margin_z), s + 1u == frame.grid.slices ? 3.0e38
      : high * (1.0 + frame.grid.margin_z));
}

// Which of a tile's 32 depth slices (Harada 2012, "2.5D culling"), by the bits again.
uint tile_slice(TileDepth t, float z) {
  const uint low = floatBitsToUint(t.z_near), width = ((floatBitsToUint(t.z_far) - low) >> 5u) + 1u;
  return (floatBitsToUint(clamp(z, t.z_near, t.z_far)) - low) / width;
}

// View space: x right, y up, z forward.
vec3 view_position(vec3 p) { return vec3(dot(p, frame.camera_right), dot(p, frame.camera_up),
    -dot(p, frame.camera_back)); }

// Tile of a point in view space; false for a point off the grid.
bool light_tile(vec3 p, out uvec2 tile) {
  const vec2 q = frame.perspective != 0u ? p.xy / p.z : p.xy;
  const vec2 size = vec2(frame.size_px);
  const vec2 px = size * 0.5 + frame.grid.px_scale * vec2(q.x, -q.y);
  tile = uvec2(clamp(px / float(frame.grid.tile_px), vec2(0.0), vec2(frame.grid.tiles) - 1.0));
  const bool in_front = frame.perspective == 0u || p.z > 0.0;
  return in_front && all(greaterThanEqual(px, vec2(-1.0))) && all(lessThanEqual(px, size + 1.0));
}

// Sides of a rectangle of tiles in the plane z = 1 (perspective: tangents; orthographic: metres), widened by the
// margin, and by a pixel where the grid ends.
void light_tile_sides(uvec2 first, uvec2 last, out vec2 low, out vec2 high) {
  const vec2 size = vec2(frame.size_px);
  vec2 px_low = vec2(first * frame.grid.tile_px) - frame.grid.margin_px;
  vec2 px_high = min(vec2((last + 1u) * frame.grid.tile_px), size) + frame.grid.margin_px;
  px_low -= vec2(equal(first, uvec2(0u)));
  px_high += vec2(greaterThanEqual(last + 1u, frame.grid.tiles));
  const vec2 a = (px_low - size * 0.5) / frame.grid.px_scale, b = (px_high - size * 0.5) / frame.grid.px_scale;
  low = vec2(a.x, -b.y);
  high = vec2(b.x, -a.y);
}
