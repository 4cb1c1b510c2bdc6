#ifndef CANDELA_SHARED_PACK_H
#define CANDELA_SHARED_PACK_H
#include "shared/types.h"
// What pack.comp makes of a picture: nothing (it is only looked at), planes of halves or of floats, one for each
// channel, or red, green and blue as whole numbers side by side. Rows begin at a multiple of four bytes.
#define PACK_NOTHING 0
#define PACK_HALF 1
#define PACK_FLOAT 2
#define PACK_RGB8 3
#define PACK_RGB16 4
SHARED_BEGIN
struct PackPush {
  uint64_t target, counts;
  uint source, layer;  // layer: its place among the counts
  uvec2 size_px;       // of what is packed
  uvec2 corner_px;     // where that begins in the picture
  uint row_words, plane_words;
  float scale;  // of colours before they are halves; not of alpha
};
// Of one layer. first_from_end: 2^32 - 1 minus the least index, row after row, of a pixel that is not finite.
struct PackCounts {
  uint nonfinite, first_from_end;
  uint clamped;  // finite values beyond half
  uint covered;  // not 0: some pixel's alpha is not 0
};
SHARED_END
#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PackCountsRef { PackCounts l[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PackWordsRef { uint w[]; };
#endif
#endif
