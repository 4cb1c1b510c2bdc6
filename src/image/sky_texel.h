#pragma once
#include <cstring>

#include "image/half.h"
#include "image/io.h"

namespace candela {

using SkyTexel = float __attribute__((vector_size(16)));

// Of an image of floats or half floats.
inline SkyTexel sky_texel(const DecodedImage& image, size_t place) {
  if (image.format == DecodedImage::Format::rgba16f) {
    uint16_t h[4];
    std::memcpy(h, image.pixels.data() + place * sizeof h, sizeof h);
    // half_to_float() of what is finite and not negative, as skies are: exponents move by a product, exactly.
    using Bits = uint32_t __attribute__((vector_size(16)));
    return SkyTexel(Bits{h[0], h[1], h[2], h[3]} << 13) * 0x1p112f;
  }
  SkyTexel texel;
  std::memcpy(&texel, image.pixels.data() + place * sizeof texel, sizeof texel);
  return texel;
}

}  // namespace candela
