#version 460
// One thread a point of a cell: which lights of its list it sees, by the rays that shading it would send.
#define TRIANGLES
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
  for (LightWalk w = begin_lights(position); next_light(w);) {
    LightRef light = light_at(pc.lights, w.light);
    const bool is_sun = floatBitsToUint(light_word(light, 3u).y) == light_directional;
    if ((LIGHT_VOXELS & (is_sun ? voxels_of_suns : voxels_of_lamps)) == 0) continue;
    vec3 l;
    // What faces away tells nothing of those that do not.
    if (light_arriving(light, position, l) == 0.0 || !(dot(rays_side, l) > 0.0)) continue;
    const float share = traced_visibility(light, w.light);
    const uint state = share >= 1.0 ? voxel_lit : share > 0.0 ? voxel_both : voxel_dark;
    atomicOr(VoxelWordRef(voxel_word_at(states, grid.words, cell, w.light / voxel_lights_a_word)).u,
        state << 2u * (w.light % voxel_lights_a_word));
  }
}
