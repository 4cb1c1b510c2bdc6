#ifndef CANDELA_SHARED_HASH_H
#define CANDELA_SHARED_HASH_H
#include "shared/types.h"
SHARED_BEGIN
struct HashSamplesPush {
  uint64_t words;  // address of what is written
  uvec2 size_px;
};
SHARED_END

#ifdef __cplusplus
namespace candela::shared {
static_assert(sizeof(HashSamplesPush) == 16);
}
#else
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer HashWordsRef { uint w[]; };
#endif

#endif
