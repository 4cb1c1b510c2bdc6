#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

// Text chunks of PNG files, without a PNG library: the container is simple (PNG specification, third edition, section
// 5).
namespace candela {

// CRC-32 of ISO 3309, as PNG takes it over a chunk's type and data.
uint32_t png_crc(std::span<const std::byte> bytes);

// The same file with one tEXt chunk before its pixels. keyword: 1 to 79 bytes; text: no zero byte.
std::vector<std::byte> with_png_text(std::span<const std::byte> png, std::string_view keyword, std::string_view text);

// The text under `keyword`, empty when there is none. Error (input) when the file is not whole: every chunk's length
// and checksum is verified up to the end mark, so a truncated or damaged file never passes, and
// nothing may follow it.
Expected<std::string> png_text(std::span<const std::byte> png, std::string_view keyword, const std::string& place);

}  // namespace candela
