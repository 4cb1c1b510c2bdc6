#include "image/png_text.h"

#include <array>
#include <cstdint>
#include <cstring>

#include "base/check.h"

namespace candela {
namespace {

constexpr std::array<uint8_t, 8> signature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

// crc_tables[k][byte]: what the byte does to the checksum when k bytes follow it.
using CrcTables = std::array<std::array<uint32_t, 256>, 8>;
constexpr CrcTables make_crc_tables() {
  CrcTables tables{};
  for (uint32_t n = 0; n < 256; ++n) {
    uint32_t c = n;
    for (int bit = 0; bit < 8; ++bit) c = (c & 1) ? 0xedb88320u ^ (c >> 1) : c >> 1;
    tables[0][n] = c;
  }
  for (size_t k = 1; k < 8; ++k)
    for (size_t n = 0; n < 256; ++n) tables[k][n] = tables[0][tables[k - 1][n] & 0xff] ^ (tables[k - 1][n] >> 8);
  return tables;
}
constexpr CrcTables crc_tables = make_crc_tables();

uint32_t big_endian(std::span<const std::byte> bytes) {
  return uint32_t(bytes[0]) << 24 | uint32_t(bytes[1]) << 16 | uint32_t(bytes[2]) << 8 | uint32_t(bytes[3]);
}
void put_big_endian(std::vector<std::byte>& out, uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(std::byte(value >> shift));
}

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

uint32_t png_crc(std::span<const std::byte> bytes) {
  uint32_t c = 0xffffffffu;
  while (bytes.size() >= 8) {
    uint32_t next = 0;
    for (size_t k = 0; k < 8; ++k) {
      const uint32_t byte = uint32_t(bytes[k]) ^ (k < 4 ? c >> (8 * k) & 0xff : 0);
      next ^= crc_tables[7 - k][byte];
    }
    c = next;
    bytes = bytes.subspan(8);
  }
  for (const std::byte b : bytes) c = crc_tables[0][(c ^ uint32_t(b)) & 0xff] ^ (c >> 8);
  return c ^ 0xffffffffu;
}

std::vector<std::byte> with_png_text(std::span<const std::byte> png, std::string_view keyword, std::string_view text) {
  constexpr size_t after_header = 8 + 12 + 13;  // the signature and IHDR, which comes first
  CHECK(png.size() >= after_header && std::memcmp(png.data(), signature.data(), 8) == 0);
  CHECK(!keyword.empty() && keyword.size() < 80 && text.find('\0') == std::string_view::npos);
  std::string chunk = "tEXt";
  chunk.append(keyword).push_back('\0');
  chunk.append(text);
  const auto bytes = std::as_bytes(std::span(chunk));
  std::vector<std::byte> out(png.begin(), png.begin() + after_header);
  put_big_endian(out, uint32_t(bytes.size() - 4));
  out.insert(out.end(), bytes.begin(), bytes.end());
  put_big_endian(out, png_crc(bytes));
  out.insert(out.end(), png.begin() + after_header, png.end());
  return out;
}

Expected<std::string> png_text(std::span<const std::byte> png, std::string_view keyword, const std::string& place) {
  const auto broken = [&](const char* why) {
    return fail(ErrorKind::input, place, "is not a whole PNG file: {}", why);
  };
  if (png.size() < 8 || std::memcmp(png.data(), signature.data(), 8) != 0) return broken("the signature is missing");
  std::string found;
  for (auto rest = png.subspan(8);;) {
    if (rest.size() < 12) return broken("it ends early");
    const uint32_t length = big_endian(rest);
    if (length > rest.size() - 12) return broken("it ends early");
    const auto type_and_data = rest.subspan(4, 4 + size_t(length));
    if (png_crc(type_and_data) != big_endian(rest.subspan(8 + size_t(length)))) return broken("a checksum is wrong");
    const std::string_view type = as_text(type_and_data.first(4)), data = as_text(type_and_data.subspan(4));
    rest = rest.subspan(12 + size_t(length));
    if (type == "tEXt" && data.size() > keyword.size() && data.starts_with(keyword) && data[keyword.size()] == 0)
      found = data.substr(keyword.size() + 1);
    if (type != "IEND") continue;
    if (!rest.empty()) return broken("bytes follow its end");
    return found;
  }
}

}  // namespace candela
