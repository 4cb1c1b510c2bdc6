#pragma once
#include <cstring>
#include <span>

#include "image/png_text.h"

namespace candela::test {

// Writes each chunk's checksum anew, so that a damaged PNG still reaches what decodes its pixels. Other files stay as
// they are.
inline void renew_png_checksums(std::span<std::byte> file) {
  if (file.size() < 8 || std::memcmp(file.data(), "\x89PNG\r\n\x1a\n", 8) != 0) return;
  for (size_t at = 8; file.size() - at >= 12;) {
    uint32_t length = 0;
    for (size_t i = 0; i < 4; ++i) length = length << 8 | uint32_t(file[at + i]);
    if (length > file.size() - at - 12) return;
    const uint32_t crc = png_crc(file.subspan(at + 4, size_t(length) + 4));
    for (size_t i = 0; i < 4; ++i) file[at + 8 + length + i] = std::byte(crc >> (24 - 8 * i));
    at += 12 + size_t(length);
  }
}

}  // namespace candela::test
