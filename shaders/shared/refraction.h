#ifndef CANDELA_SHARED_REFRACTION_H
#define CANDELA_SHARED_REFRACTION_H
#include "shared/types.h"

SHARED_BEGIN
// A level of what is seen through glass: texels of the level before, or of the picture, by the area that they share.
struct RefractionDownPush {
  uint source, target;
  uvec2 source_px, target_px;
};
SHARED_END

// The places of four images among those of the pass, in one word.
#define REFRACTION_IMAGES(picture, pyramid, depth, rays) ((picture) | (pyramid) << 8 | (depth) << 16 | (rays) << 24)
#define REFRACTION_PLACE(images, number) ((images) >> (8u * (number)) & 0xffu)

#endif
