#pragma once
#include "gpu/resources.h"
#include "image/io.h"

namespace candela {

// A decoded image as a texture with all its mip levels, made on the CPU so that every device samples the same texels.
// Each level is the area mean of the one before, in linear light: sRGB values are decoded first and encoded again. srgb
// with 16-bit texels gives linear 16-bit ones, since Vulkan has no such sRGB format.
//
// normals: the image is a normal map. Then alpha says how far the normals that a texel stands for stray from their
// mean: the standard deviation of their slopes along an axis, up to 1, by the mean's length against that of what it is
// made of (Toksvig, "Mipmapping Normal Maps", 2005). 0 in level 0.
gpu::TextureData make_mip_chain(DecodedImage image, bool srgb, bool mipmaps, bool normals = false);

// Of four linear floats a texel: the levels below the first one, which is there, in the memory that they have. The same
// texels as make_mip_chain().
void add_float_levels(gpu::TextureData& data);

}  // namespace candela
