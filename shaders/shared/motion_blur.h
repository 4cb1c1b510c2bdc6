#ifndef CANDELA_SHARED_MOTION_BLUR_H
#define CANDELA_SHARED_MOTION_BLUR_H
#include "shared/types.h"
// Push constants of motion_tiles.comp and motion_gather.comp (src/passes/post/motion_blur.h).
SHARED_BEGIN

struct MotionTilesPush {
  uint source, target;
  uvec2 size_px, tiles;
  uint side;    // of a tile, px; the longest motion
  float share;  // of the motion: to either side of a pixel
};
struct MotionGatherPush {
  uint64_t keys;  // in the place of depth
  uint color, motion, neighbours, depth, target;
  uint side, samples;
  float share;
  uvec2 size_px;
  uint seed;
};

SHARED_END
#endif
