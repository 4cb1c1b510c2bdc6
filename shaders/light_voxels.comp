#version 460
// A workgroup a tile: which cells its pixels' surfaces lie in, and of each cell the points that lie outermost in
// several directions, so that what differs over the cell differs between them.
#include "shared/voxels.h"
layout(push_constant, scalar) uniform Push { VoxelPush pc; };
#include "lib/bindless.glsl"
#include "lib/frame.glsl"
#include "lib/frame_depth.glsl"
#include "lib/sample_places.glsl"
#include "lib/light_voxels.glsl"
layout(local_size_x = 64) in;
layout(constant_id = 30) const int SAMPLES = 1;
layout(constant_id = 31) const int TILE_PX = 8;
layout(constant_id = 32) const int POINTS = 4;

const int THREADS = 64, PIXELS = TILE_PX * TILE_PX, OWN = (PIXELS + THREADS - 1) / THREADS;
const int BORDERED = TILE_PX + 2;
const ivec2 OUTWARDS[8] = ivec2[](ivec2(-1, -1), ivec2(1, 1), ivec2(1, -1), ivec2(-1, 1), ivec2(-1, 0), ivec2(1, 0),
                                  ivec2(0, -1), ivec2(0, 1));

shared float depths[BORDERED * BORDERED];  // metres along the view axis, with a border of a pixel; 0: no surface
shared uint least, pixels;
shared uint outermost[voxel_tile_cells][POINTS];  // 1 + how far out, 12 bits up; and the pixel

// As lib/view_ray.glsl, of the frame's own picture.
vec3 point_of(ivec2 pixel, float depth_m) {
  const vec2 ndc = 2.0 * (vec2(pixel) + sample_place_px(SAMPLES, 0u)) / vec2(frame.size_px) - 1.0;
  const vec3 off = ndc.x * frame.tan_half.x * frame.camera_right - ndc.y * frame.tan_half.y * frame.camera_up;
  return off * (frame.perspective != 0u ? depth_m : 1.0) - depth_m * frame.camera_back;
}
float depth_m_of(ivec2 pixel) {
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, ivec2(frame.size_px)))) return 0.0;
  const float d = frame_depth(pixel, 0, SAMPLES);
  if (!(d > 0.0)) return 0.0;
  const mat4 m = frame.clip_from_relative;
  if (frame.perspective != 0u) return m[3][2] / d;
  return max((m[3][2] - d) / length(vec3(m[0][2], m[1][2], m[2][2])), 0.0);
}
float depth_in_tile(ivec2 p) { return depths[(p.y + 1) * BORDERED + p.x + 1]; }

// How the surface runs along an axis of the picture: towards the neighbour whose depth differs less.
vec3 along(ivec2 corner, ivec2 p, ivec2 step) {
  const float here = depth_in_tile(p), before = depth_in_tile(p - step), behind = depth_in_tile(p + step);
  const bool forward = behind > 0.0 && !(before > 0.0 && abs(before - here) < abs(behind - here));
  if (forward) return point_of(corner + p + step, behind) - point_of(corner + p, here);
  return before > 0.0 ? point_of(corner + p, here) - point_of(corner + p - step, before) : vec3(0.0);
}

void main() {
  const int t = int(gl_LocalInvocationIndex);
  const uvec2 tile = gl_WorkGroupID.xy;
  const ivec2 corner = ivec2(tile) * TILE_PX;
  for (int i = t; i < BORDERED * BORDERED; i += THREADS)
    depths[i] = depth_m_of(corner + ivec2(i % BORDERED, i / BORDERED) - 1);
  for (int i = t; i < int(voxel_tile_cells) * POINTS; i += THREADS) outermost[i / POINTS][i % POINTS] = 0u;
  barrier();
  const uint slice_shift = voxel_slice_shift(uint(TILE_PX));
  uint keys[OWN];
  for (int i = 0; i < OWN; ++i) {
    const int number = t + THREADS * i;
    const ivec2 p = ivec2(number % TILE_PX, number / TILE_PX);
    keys[i] = 0u;
    if (number >= PIXELS || !(depth_in_tile(p) > 0.0)) continue;
    // Towards the viewer: the picture's y runs down.
    const vec3 normal = cross(along(corner, p, ivec2(0, 1)), along(corner, p, ivec2(1, 0)));
    keys[i] = voxel_key(depth_in_tile(p), slice_shift, voxel_side(normal));
  }
  // Cells in the order of their keys; more than a tile has room for are left out, and those of so few pixels that rays
  // from all of them are hardly more.
  const uint place = tile.x + pc.tiles.x * tile.y;
  VoxelTilesRef tiles = VoxelTilesRef(voxel_tiles_at(pc.voxels));
  uint count = 0u, last = 0u;
  while (count < voxel_tile_cells) {
    if (t == 0) {
      least = 0xffffffffu;
      pixels = 0u;
    }
    barrier();
    for (int i = 0; i < OWN; ++i)
      if (keys[i] > last) atomicMin(least, keys[i]);
    barrier();
    last = least;
    if (last == 0xffffffffu) break;
    for (int i = 0; i < OWN; ++i)
      if (keys[i] == last) atomicAdd(pixels, 1u);
    barrier();
    const bool pays = pixels >= 2u * uint(POINTS);
    barrier();
    if (!pays) continue;
    if (t == 0) tiles.t[place].keys[count] = last;
    for (int i = 0; i < OWN; ++i) {
      if (keys[i] != last) continue;
      const int number = t + THREADS * i;
      const ivec2 p = ivec2(number % TILE_PX, number / TILE_PX);
      for (int k = 0; k < POINTS; ++k) {
        const ivec2 to = OUTWARDS[k] * p;
        atomicMax(outermost[count][k], uint(1 + to.x + to.y + 2 * TILE_PX) << 12u | uint(number));
      }
    }
    ++count;
  }
  if (t == 0) tiles.t[place].count = count;
  barrier();
  for (int i = t; i < int(voxel_tile_cells) * POINTS; i += THREADS) {
    const uint cell = uint(i / POINTS), number = outermost[cell][i % POINTS] & 0xfffu;
    bool again = cell >= count;  // none, or an earlier one's
    for (int k = 0; k < i % POINTS; ++k) again = again || (outermost[cell][k] & 0xfffu) == number;
    const ivec2 p = ivec2(int(number) % TILE_PX, int(number) / TILE_PX);
    VoxelWordRef(pc.points + 4ul * (uint64_t(place) * uint64_t(voxel_tile_cells * uint(POINTS)) + uint64_t(i))).u =
        again ? 0u : voxel_point(number, depth_in_tile(p));
  }
}
