#pragma once
#include "gpu/resources.h"
#include "image/io.h"

namespace candela {

// A decoded image as a texture with all its mip levels, made on the CPU so that every device samples the same texels.
// Each level is the area mean of the one before, in linear light: sRGB values are decoded first and encoded again. srgb
// with 16-bit texels gives linear 16-bit ones, since Vulkan has no such sRGB format.
gpu::TextureData make_mip_chain(const DecodedImage& image, bool srgb, bool mipmaps);

}  // namespace candela
