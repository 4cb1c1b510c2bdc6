#ifndef CANDELA_SHARED_SMOOTH_EDGES_H
#define CANDELA_SHARED_SMOOTH_EDGES_H
#include "shared/types.h"
// Push constants of smooth_edges.comp (src/passes/post/smooth_edges.h).
SHARED_BEGIN
struct SmoothEdgesPush {
  uint color, source, target;  // source: what the step before made
  uvec2 size_px;
  uint reach_px;
  float threshold, exposure;
};
SHARED_END
#endif
