#version 460
// One thread a light: its box of cells, and the box's chunks. The formulas are those of passes/lights/light_grid.cpp,
// in double too, with the cone's angle by its sine and cosine.
#include "shared/scene.h"
#include "shared/pose_lights.h"
layout(push_constant, scalar) uniform Push { LightBoundsPush pc; };
#include "lib/frame.glsl"
layout(local_size_x = 64) in;
layout(constant_id = 0) const int TILED = 0;

layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer BoundsOutRef { LightBounds b[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer ChunksOutRef { LightChunk c[]; };

const double UNBOUNDED = 1e300lf;
const double INFLATED_RANGE = 1.0lf + 1.0lf / 1024.0lf;
const double COS_INFLATED = 0.99999950000004166667lf, SIN_INFLATED = 0.00099999983333334166667lf;  // of 1e-3 radians

// x/z over the part of a ball in front of the camera, or x itself for an orthographic one.
dvec2 projected(double x, double z, double radius) {
  if (frame.perspective == 0u) return dvec2(x - radius, x + radius);
  dvec2 range = dvec2(-UNBOUNDED, UNBOUNDED);
  const double distance2 = x * x + z * z, t2 = distance2 - radius * radius;
  if (!(t2 > 1e-9lf * distance2)) return range;
  const double t = sqrt(t2);
  const double low = z * t + x * radius, high = z * t - x * radius;
  if (low > 1e-12lf * distance2) range.x = (x * t - z * radius) / low;
  if (high > 1e-12lf * distance2) range.y = (x * t + z * radius) / high;
  return range;
}

dvec2 cut(dvec2 a, dvec2 b) { return dvec2(max(a.x, b.x), min(a.y, b.y)); }

// How far a cone with a spherical cap reaches along a direction whose cosine with its axis this is.
double cone_reach(double cosine, double range, double cos_half, double sin_half) {
  if (cosine >= cos_half) return range;
  return max(0.0lf, range * (cosine * cos_half + sqrt(max(1.0lf - cosine * cosine, 0.0lf)) * sin_half));
}

uint slice(double z) {
  const float depth = float(clamp(z, 0.0lf, 3e38lf));
  const int s = int(floatBitsToUint(depth) >> frame.grid.slice_shift) - frame.grid.slice_base;
  return uint(clamp(s, 0, int(frame.grid.slices) - 1));
}

bool tiles_of(dvec2 px, uint size, uint tiles, out uint first, out uint last) {
  px += dvec2(-frame.grid.margin_px, frame.grid.margin_px);
  const double most = double(tiles - 1u), tile_px = double(frame.grid.tile_px);
  first = uint(clamp(floor(px.x / tile_px), 0.0lf, most));
  last = uint(clamp(floor(px.y / tile_px), 0.0lf, most));
  return px.x <= px.y && px.y >= -1.0lf && px.x <= double(size) + 1.0lf;
}

dvec3 in_view(vec3 v) {
  const dvec3 d = dvec3(v);
  return dvec3(dot(d, dvec3(frame.camera_right)), dot(d, dvec3(frame.camera_up)), -dot(d, dvec3(frame.camera_back)));
}

// False: it reaches no cell, or every one.
bool bounds_of(Light l, out LightBounds b) {
  b = LightBounds(vec3(0.0), 0.0, vec3(0.0), -2.0, 0.0, 0.0, 0.0, 0u, uvec3(0u), uvec3(0u));
  if (l.type == light_directional || l.inverse_range == 0.0) return false;
  const dvec3 position = in_view(l.position), direction = in_view(l.direction);
  const double range = INFLATED_RANGE / double(l.inverse_range);
  b.position = vec3(position);
  b.radius = float(range);
  b.direction = vec3(direction);
  dvec2 z = dvec2(position.z - range, position.z + range);
  dvec2 x = projected(position.x, position.z, double(b.radius));
  dvec2 y = projected(position.y, position.z, double(b.radius));
  if (l.type == light_spot) {
    // 1 - cosine, as the shading has it, then inflated.
    const double open = clamp(double(l.spot_offset) / (2.0lf * double(l.spot_scale)), 0.0lf, 2.0lf);
    const double c = 1.0lf - open, s = sqrt(open * (2.0lf - open));
    const double cos_half = c * COS_INFLATED - s * SIN_INFLATED, sin_half = s * COS_INFLATED + c * SIN_INFLATED;
    if (cos_half > 0.0lf) {
      b.cos_outer = float(cos_half);
      b.sin_outer = float(sin_half);
      const double cosine = clamp(direction.z, -1.0lf, 1.0lf), margin = 1e-3lf * range;
      z = cut(z, dvec2(position.z - cone_reach(-cosine, range, cos_half, sin_half) - margin,
          position.z + cone_reach(cosine, range, cos_half, sin_half) + margin));
      const bool narrow = 2.0lf * cos_half * cos_half > 1.0lf;
      const double along = narrow ? range / (2.0lf * cos_half) : range * cos_half;
      const double radius = 1.0001lf * (narrow ? along : range * sin_half);
      const dvec3 middle = position + direction * along;
      x = cut(x, projected(middle.x, middle.z, radius));
      y = cut(y, projected(middle.y, middle.z, radius));
    }
  }
  z += abs(z) * dvec2(-1e-6lf, 1e-6lf);
  b.z_low = float(z.x);
  b.z_high = float(z.y);
  const dvec2 middle_px = dvec2(frame.size_px) * 0.5lf, scale = dvec2(frame.grid.px_scale);
  const bool behind = frame.perspective != 0u && z.y <= 0.0lf;
  if (behind || z.x > z.y) return false;
  if (!tiles_of(middle_px.x + scale.x * x, frame.size_px.x, frame.grid.tiles.x, b.first.x, b.last.x)) return false;
  if (!tiles_of(middle_px.y - scale.y * y.yx, frame.size_px.y, frame.grid.tiles.y, b.first.y, b.last.y)) return false;
  if (TILED == 0) {
    b.first.z = slice(z.x - abs(z.x) * double(frame.grid.margin_z));
    b.last.z = slice(z.y + abs(z.y) * double(frame.grid.margin_z));
  }
  return true;
}

uint chunks_of(uvec3 first, uvec3 last) {
  const uvec3 n = last - first + 1u;
  return (n.x * n.y * n.z + light_chunk_cells - 1u) / light_chunk_cells;
}

shared uint ends[2][64];  // prefix sums of the group's chunks
shared uint places[64];   // of their boxes
shared uint group_base;

// All threads of the group write its chunks: a few lights may have most of them.
void add_chunks(uint place, uint count, uint column) {
  const uint t = gl_LocalInvocationIndex;
  uint from = 0u;
  ends[0][t] = count;
  places[t] = place;
  barrier();
  for (uint step = 1u; step < 64u; step *= 2u) {
    ends[1u - from][t] = ends[from][t] + (t >= step ? ends[from][t - step] : 0u);
    from = 1u - from;
    barrier();
  }
  const uint total = ends[from][63];
  if (t == 0u && total > 0u) {
    group_base = atomicAdd(UintsRef(pc.dispatch).u[0], total);
    const uint groups = ((group_base + total) * light_chunk_cells + light_group - 1u) / light_group;
    atomicMax(UintsRef(pc.dispatch).u[1], min(groups, 65535u));
    atomicMax(UintsRef(pc.dispatch).u[2], (groups + 65534u) / 65535u);
    atomicMax(UintsRef(pc.dispatch).u[3], 1u);
  }
  barrier();
  for (uint i = t; i < total; i += 64u) {
    uint low = 0u, high = 63u;  // the first light whose chunks end behind this one
    while (low < high) {
      const uint middle = (low + high) / 2u;
      if (ends[from][middle] > i)
        high = middle;
      else
        low = middle + 1u;
    }
    const uint before = low > 0u ? ends[from][low - 1u] : 0u;
    ChunksOutRef(pc.chunks).c[group_base + i] = LightChunk(places[low], (i - before) * light_chunk_cells, column);
  }
  barrier();
}

void main() {
  const uint light = (gl_WorkGroupID.y * 65535u + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  LightBounds b;
  const bool reaches = bounds_of(LightsRef(pc.lights).l[min(light, pc.light_count - 1u)], b) && light < pc.light_count;
  uint place = 0u;
  if (reaches) {
    b.light = light;
    place = atomicAdd(UintsRef(pc.bounds_count).u[0], 1u);
    BoundsOutRef(pc.bounds).b[place] = b;
  }
  add_chunks(place, reaches ? chunks_of(b.first, b.last) : 0u, 0u);
  if (TILED == 0) return;
  const uvec3 first = uvec3(b.first.xy / column_tiles, 0u), last = uvec3(b.last.xy / column_tiles, 0u);
  add_chunks(place, reaches ? chunks_of(first, last) : 0u, 1u);
}
