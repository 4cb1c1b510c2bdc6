#version 460
// Sorts a pixel's fragments, farthest first and then in the order of drawing, and lays them over what is behind them,
// sample by sample: surfaces that cross inside a pixel are in the order of each sample's own depth.
#include "shared/transparency.h"
layout(push_constant, scalar) uniform Push { FragmentsPush pc; };
#include "lib/bindless.glsl"
#include "lib/sample_places.glsl"
layout(local_size_x = 64) in;
layout(constant_id = 0) const int SAMPLES = 1;

uint first;      // of the pixel's fragments
vec2 to_sample;  // from the pixel's middle, in pixels

float depth_of(uint i) {
  const float depth = StoredRef(pc.stored).f[first + i].depth;
  if (SAMPLES == 1) return depth;
  const float z = depth + dot(StoredRef(pc.stored).f[first + i].slope, to_sample);
  return abs(z) < 1e30 ? z : depth;  // seen edge on there is no slope
}
bool lies_below(uint a, uint b) {
  const float za = depth_of(a), zb = depth_of(b);
  if (za != zb) return za < zb;
  const uint ia = StoredRef(pc.stored).f[first + a].item, ib = StoredRef(pc.stored).f[first + b].item;
  if (ia != ib) return ia < ib;
  return StoredRef(pc.stored).f[first + a].primitive < StoredRef(pc.stored).f[first + b].primitive;
}
uint ordered(uint place) { return OrderRef(pc.order).i[first + place]; }
void put(uint place, uint i) { OrderRef(pc.order).i[first + place] = i; }

// Heap sort: few steps for any number, and no memory but the order's own.
void sift(uint top, uint count) {
  const uint moved = ordered(top);
  for (uint child = 2u * top + 1u; child < count; child = 2u * top + 1u) {
    if (child + 1u < count && lies_below(ordered(child), ordered(child + 1u))) ++child;
    if (!lies_below(moved, ordered(child))) break;
    put(top, ordered(child));
    top = child;
  }
  put(top, moved);
}
void sort(uint count) {
  if (count <= 16u) {
    for (uint n = 1u; n < count; ++n) {
      const uint moved = ordered(n);
      uint to = n;
      for (; to > 0u && lies_below(moved, ordered(to - 1u)); --to) put(to, ordered(to - 1u));
      put(to, moved);
    }
    return;
  }
  for (uint top = count / 2u; top-- > 0u;) sift(top, count);
  for (uint last = count - 1u; last > 0u; --last) {
    const uint most = ordered(0u);
    put(0u, ordered(last));
    put(last, most);
    sift(0u, last);
  }
}

void main() {
  const uvec2 quads = (pc.size_px + 1u) / 2u;
  const uint across = gl_GlobalInvocationID.x;
  if (across >= 4u * quads.x) return;
  const uint quad = gl_WorkGroupID.y * quads.x + across / 4u, pixel = 4u * quad + across % 4u;
  CellWordsRef cells = CellWordsRef(pc.cells);
  const uint count = cells.w[first_count + pixel], offset = cells.w[first_offset(pc.size_px) + quad];
  if (count == 0u || offset / pc.room != pc.round_number) return;
  first = offset % pc.room;
  for (uint i = 4u * quad; i < pixel; ++i) first += cells.w[first_count + i];
  for (uint i = 0u; i < count; ++i) put(i, i);
  const ivec2 p = ivec2(2u * (across / 4u) + (across & 1u), 2u * gl_WorkGroupID.y + (across >> 1u & 1u));
  for (int s = 0; s < SAMPLES; ++s) {
    to_sample = sample_place_px(SAMPLES, uint(s)) - 0.5;
    sort(count);
    precise vec4 color = SAMPLES > 1 ? texelFetch(pass_multisampled_images[pc.color], p, s)
        : texelFetch(pass_images[pc.color], p, 0);
    for (uint i = 0u; i < count; ++i) {
      const StoredFragment f = StoredRef(pc.stored).f[first + ordered(i)];
      if ((f.covers >> uint(s) & 1u) != 0u) color = f.radiance + (1.0 - f.radiance.a) * color;
    }
    BlendedRef(pc.blended).c[pixel * uint(SAMPLES) + uint(s)] = color;
  }
}
