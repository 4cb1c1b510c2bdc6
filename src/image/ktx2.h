#pragma once
#include <span>
#include <string>

#include "base/error.h"
#include "image/io.h"

namespace candela {

// KTX 2 files with Basis Universal texels, as KHR_texture_basisu has them, or plain ones of 8 bits: one flat image,
// ETC1S, UASTC, or one to four channels, decoded to RGBA of 8 bits. Level 0 alone is read; mips are made from it as for
// every other image.
bool is_ktx2(std::span<const std::byte> bytes);
Expected<ImageInfo> probe_ktx2(std::span<const std::byte> bytes, const std::string& place);
// The caller has bounded the size.
Expected<DecodedImage> decode_ktx2(std::span<const std::byte> bytes, const std::string& place);

}  // namespace candela
