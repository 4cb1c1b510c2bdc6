#version 460
// One thread a point of a cell: which lights of its list it sees, by the rays that shading it would send.
#define TRIANGLES
#ifndef TRACES  // as frames say that send rays
#define TRACES
#endif
#include "shared/draw.h"
#include "shared/voxels.h"
layout(push_constant, scalar) uniform Push { DrawPush pc; };
#include "lib/features.glsl"
#include "lib/scene.glsl"
#include "lib/surface.glsl"
#include "lib/view_ray.glsl"
#include "lib/sample_places.glsl"
#include "lib/brdf.glsl"
#include "lib/light_eval.glsl"
#include "lib/light_cells.glsl"
#include "lib/light_list.glsl"
#include "lib/traced_light.glsl"
#include "lib/light_voxels.glsl"
layout(local_size_x = 64) in;

// The cells that a point tells what it sees: its own, and those beside it in which its surface may go on, by side and
// depth, so that a shadow's edge between two cells is seen by both.
const uint most_beside = 16u;
uint beside[most_beside];
uint find_beside(uint64_t voxels, VoxelGrid grid, ivec2 tile, uint key) {
  const ivec2 steps[5] = ivec2[](ivec2(0), ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));
  VoxelTilesRef tiles = VoxelTilesRef(voxel_tiles_at(voxels));
  uint count = 0u;
  for (int i = 0; i < 5; ++i) {
    const ivec2 at = tile + steps[i];
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, ivec2(grid.tiles)))) continue;
    const uint number = uint(at.x) + grid.tiles.x * uint(at.y);
    const uint cells = min(tiles.t[number].count, voxel_tile_cells);
    for (uint k = 0u; k < cells && count < most_beside; ++k) {
      const int off = int(tiles.t[number].keys[k]) - int(key);
      const uint cell = tiles.t[number].first + k;
      if ((off == 0 || abs(off) == 8) && cell < grid.capacity) beside[count++] = cell;
    }
  }
  return count;
}

layout(constant_id = 30) const int SAMPLES = 1;
layout(constant_id = 32) const int POINTS = 4;

void main() {
  const uint64_t voxels = pc.deformed_before;
  const VoxelGrid grid = VoxelGridRef(voxels).g;
  const uint thread = (gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  const uint cell = min(thread / uint(POINTS), grid.capacity - 1u);
  const uint place = VoxelWordRef(voxel_places_at(voxels, grid.tiles) + 4ul * uint64_t(cell)).u;
  if (thread / uint(POINTS) >= grid.capacity || place == 0u) return;
  const uint64_t number = uint64_t(place - 1u) * uint64_t(POINTS) + uint64_t(thread % uint(POINTS));
  const uint point = VoxelWordRef(pc.table + 4ul * number).u, in_tile = voxel_point_pixel(point);
  if (point == 0u) return;
  const uint tile = (place - 1u) / voxel_tile_cells;
  const uvec2 pixel = uvec2(tile % grid.tiles.x, tile / grid.tiles.x) * grid.tile_px +
      uvec2(in_tile % grid.tile_px, in_tile / grid.tile_px);
  pixel_middle = vec2(pixel) + 0.5;
  const ViewRay seen = view_ray(vec2(pixel) + sample_place_px(SAMPLES, 0u));
  const vec3 position = seen.origin + voxel_point_depth_m(point) * seen.direction;
  begin_rays(position, -normalize(seen.direction));
  // A neighbour's surface may have stood in for its own when its side was guessed.
  const uint key = VoxelTilesRef(voxel_tiles_at(voxels)).t[tile].keys[(place - 1u) % voxel_tile_cells];
  if (voxel_side(rays_side) != ((key - 1u) & 7u)) return;
  const uint64_t states = voxel_states_at(voxels, grid.tiles, grid.capacity);
  const uint told = find_beside(voxels, grid, ivec2(tile % grid.tiles.x, tile / grid.tiles.x), key);
  for (LightWalk w = begin_lights(position); next_light(w);) {
    LightRef light = light_at(pc.lights, w.light);
    const bool is_sun = floatBitsToUint(light_word(light, 3u).y) == light_directional;
    if ((LIGHT_VOXELS & (is_sun ? voxels_of_suns : voxels_of_lamps)) == 0) continue;
    vec3 l;
    // What faces away tells nothing of those that do not.
    if (light_arriving(light, position, l) == 0.0 || !(dot(rays_side, l) > 0.0)) continue;
    const float fraction = traced_visibility(light, w.light);
    const uint state = fraction >= 1.0 ? voxel_lit : fraction > 0.0 ? voxel_both : voxel_dark;
    for (uint i = 0u; i < told; ++i)
      atomicOr(VoxelWordRef(voxel_word_at(states, grid.words, beside[i], w.light / voxel_lights_a_word)).u,
          state << 2u * (w.light % voxel_lights_a_word));
  }
}
