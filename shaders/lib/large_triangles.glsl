#pragma once
// The list of large triangles. Needs RasterizePush as pc.
struct LargeCount {
  uint triangles;
  uint64_t tiles;
};
LargeCount large_count() {
  LargeRef large = LargeRef(pc.large);
  const uint64_t ends = large.ends;
  const uint tried = uint(ends >> large_tile_bits), listed = min(tried, pc.most_large);
  return LargeCount(listed, tried > listed ? large.t[listed].first_tile : ends & large_tile_mask);
}
