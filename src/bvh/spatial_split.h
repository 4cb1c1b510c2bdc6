#pragma once
#include <span>

#include "bvh/build_box.h"

namespace candela {

// Both parts of a reference cut by a plane across `axis`. The triangle is cut anew and then bounded by the reference's
// own box, so parts of parts stay tight; what rounding may be off is added, so both together still hold the whole part.
struct CutReference {
  BuildBox left, right;
  bool has_left = false, has_right = false;
};

struct SpatialSplit {
  int axis = -1;
  float plane = 0;
  float cost = std::numeric_limits<float>::infinity();
  uint32_t left = 0, right = 0;  // references on each side; straddling ones count twice
  BuildBox left_box, right_box;
};
// The best plane of `buckets` equal slabs of the node's box, on any axis, that adds at most `room` references.
SpatialSplit find_spatial_split(Span references, std::span<const TriangleCorners> triangles, const BuildBox& box,
                                int buckets, uint32_t block_shift, uint32_t room);

struct SplitCounts {
  uint32_t left = 0, right = 0;
};
// Partitions `count` references at `references`, followed by `room` free ones: those of the left side come first, then
// those of the right side. A straddling reference is cut in two while there is room, unless the costs say that it
// belongs on one side whole ("reference unsplitting").
SplitCounts apply_spatial_split(BoxReference* references, uint32_t count, uint32_t room,
                                std::span<const TriangleCorners> triangles, const SpatialSplit& split);

}  // namespace candela
