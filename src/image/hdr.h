#pragma once
#include <span>
#include <string>

#include "base/error.h"
#include "image/io.h"

namespace candela {

bool is_hdr(std::span<const std::byte> bytes);
Expected<ImageInfo> probe_hdr(std::span<const std::byte> bytes, const std::string& place);
Expected<DecodedImage> decode_hdr(std::span<const std::byte> bytes, const std::string& place, int max_side);

}  // namespace candela
