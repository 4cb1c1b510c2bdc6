#ifndef CANDELA_SHARED_MATTES_H
#define CANDELA_SHARED_MATTES_H
#include "shared/types.h"
#define MATTE_LEVELS_A_STEP 8
SHARED_BEGIN
struct MatteRanksPush {
  uint64_t report;  // two counters: pixels with more ids than ranks, and the most ids of a pixel; 0: not counted
  uvec2 size_px;
  uint source;                        // ids at the samples
  uint first_rank, ranks;             // of this step, and of all
  uint targets[MATTE_LEVELS_A_STEP];  // two ranks each: id, coverage, id, coverage
};
SHARED_END
#endif
