#pragma once
// Cells of the view that know which lights are seen from them: where they are, and what they know (shared/voxels.h,
// passes/shadows/light_voxels.h). Needs lib/frame.glsl.
#include "shared/voxels.h"

const uint no_voxel = 0xffffffffu;
const uint voxel_unknown = 0u, voxel_lit = 1u, voxel_dark = 2u, voxel_both = 3u;

// Which of six ways a surface faces: its normal's largest axis and that one's sign.
uint voxel_side(vec3 normal) {
  const vec3 size = abs(normal);
  const uint axis = size.x > size.y ? (size.x > size.z ? 0u : 2u) : (size.y > size.z ? 1u : 2u);
  return 2u * axis + (normal[axis] < 0.0 ? 1u : 0u);
}
// The slice of depth z is floatBitsToUint(z) >> this: slices up to four times as thick as a tile is wide, and no
// thicker than an eighth of their depth; orthographic ones, whose tiles are as wide at all depths, sixteen an octave.
uint voxel_slice_shift(uint tile_px) {
  precise float an_octave = float(frame.size_px.y) / (8.0 * float(tile_px) * frame.tan_half.y);
  return 23u - (frame.perspective != 0u ? clamp((floatBitsToUint(an_octave) >> 23u) - 126u, 3u, 12u) : 4u);
}
// A point of a cell: its pixel in the tile, x + y * tile_px, and how far off it is, with 14 bits behind the first
// place, which tell surfaces apart. 0: none.
uint voxel_point(uint pixel, float depth_m) { return floatBitsToUint(depth_m) >> 9u << 10u | pixel; }
float voxel_point_depth_m(uint point) { return uintBitsToFloat(point >> 10u << 9u); }
uint voxel_point_pixel(uint point) { return point & 1023u; }

uint voxel_key(float depth_m, uint slice_shift, uint side) {
  return 1u + 8u * (floatBitsToUint(max(depth_m, 0.0)) >> slice_shift) + side;
}

uint64_t voxel_tiles_at(uint64_t voxels) { return voxels + uint64_t(voxel_grid_bytes); }
uint64_t voxel_places_at(uint64_t voxels, uvec2 tiles) {
  return voxel_tiles_at(voxels) + uint64_t(voxel_tile_bytes) * uint64_t(tiles.x * tiles.y);
}
uint64_t voxel_states_at(uint64_t voxels, uvec2 tiles, uint capacity) {
  return voxel_places_at(voxels, tiles) + 4ul * uint64_t(capacity);
}
uint64_t voxel_word_at(uint64_t states, uint words, uint cell, uint word) {
  return states + 4ul * (uint64_t(cell) * uint64_t(words) + uint64_t(word));
}

// The cell of a point that is seen, by its position, relative, and the side that its surface faces.
uint find_voxel(uint64_t voxels, VoxelGrid grid, vec3 position, uint side) {
  const vec3 p = vec3(dot(position, frame.camera_right), dot(position, frame.camera_up),
      -dot(position, frame.camera_back));
  const vec2 q = (frame.perspective != 0u ? p.xy / p.z : p.xy) / frame.tan_half;
  const vec2 px = (0.5 + 0.5 * vec2(q.x, -q.y)) * vec2(frame.size_px);
  const bool in_picture =
      p.z > 0.0 && all(greaterThanEqual(px, vec2(0.0))) && all(lessThan(px, vec2(frame.size_px)));
  const uvec2 tile = in_picture ? uvec2(px) / grid.tile_px : uvec2(0u);
  VoxelTilesRef tiles = VoxelTilesRef(voxel_tiles_at(voxels));
  const uint number = tile.x + grid.tiles.x * tile.y;
  const uint key = voxel_key(p.z, grid.slice_shift, side);
  uint cell = no_voxel;
  if (in_picture)
    for (uint i = 0u; i < min(tiles.t[number].count, voxel_tile_cells); ++i)
      if (tiles.t[number].keys[i] == key) cell = tiles.t[number].first + i;
  return cell < grid.capacity ? cell : no_voxel;
}
