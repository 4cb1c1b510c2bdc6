#pragma once
#include <span>
#include <string>

#include "base/error.h"
#include "image/io.h"

namespace candela {

// WebP, lossy or lossless, through libwebp's decoder, which is inside the program. Films are refused.
bool is_webp(std::span<const std::byte> bytes);
Expected<ImageInfo> probe_webp(std::span<const std::byte> bytes, const std::string& place);
// The caller has bounded the size.
Expected<DecodedImage> decode_webp(std::span<const std::byte> bytes, const std::string& place);

}  // namespace candela
