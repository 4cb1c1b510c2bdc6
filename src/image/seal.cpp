#include "image/seal.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>

#include "base/hash.h"
#include "image/png_text.h"

namespace candela {
namespace {

constexpr size_t hash_digits = 32, length_digits = 16, seal_size = hash_digits + 1 + length_digits;

// Where the seal's text begins; PNG has a checksum behind it, which the hash leaves out.
struct Place {
  size_t text = 0;
  bool png = false;
};

std::optional<Place> place_in(std::span<const std::byte> file) {
  const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
  const bool png = text.starts_with("\x89PNG");
  // As PNG writes it, and as EXR: a string attribute has its type and its length before its text.
  using namespace std::string_literals;
  const std::string before = png ? "tEXt" + std::string(seal_name) + "\0"s
                                 : std::string(seal_name) + "\0string\0"s + char(seal_size) + "\0\0\0"s;
  const size_t at = text.find(before);
  if (at == text.npos || text.size() - at < before.size() + seal_size + 4) return {};
  return Place{at + before.size(), png};
}

Hash128 hash_without(std::span<std::byte> file, const Place& place) {
  std::fill_n(file.begin() + ptrdiff_t(place.text), hash_digits, std::byte('0'));
  if (place.png) std::fill_n(file.begin() + ptrdiff_t(place.text + seal_size), 4, std::byte{});
  return hash128(file);
}

}  // namespace

std::string open_seal() { return std::string(hash_digits, '0') + " " + std::string(length_digits, '0'); }

void seal_file(std::span<std::byte> file) {
  const auto place = place_in(file);
  if (!place) return;
  const std::string length = fmt::format("{:016x}", file.size());
  std::memcpy(file.data() + place->text + hash_digits + 1, length.data(), length_digits);
  const std::string hash = hash_without(file, *place).hex();
  std::memcpy(file.data() + place->text, hash.data(), hash_digits);
  if (!place->png) return;
  const size_t chunk = place->text - seal_name.size() - 1 - 4;
  const uint32_t crc = png_crc(file.subspan(chunk, place->text + seal_size - chunk));
  for (size_t i = 0; i < 4; ++i) file[place->text + seal_size + i] = std::byte(crc >> (24 - 8 * i));
}

bool seal_holds(std::span<std::byte> file) {
  const auto place = place_in(file);
  if (!place || sealed_length(file) != file.size()) return false;
  const std::string hash(reinterpret_cast<const char*>(file.data()) + place->text, hash_digits);
  return hash_without(file, *place).hex() == hash;
}

std::optional<uint64_t> sealed_length(std::span<const std::byte> beginning) {
  const auto place = place_in(beginning);
  if (!place) return {};
  const char* digits = reinterpret_cast<const char*>(beginning.data()) + place->text + hash_digits + 1;
  uint64_t length = 0;
  const auto [end, error] = std::from_chars(digits, digits + length_digits, length, 16);
  return error == std::errc{} && end == digits + length_digits ? std::optional(length) : std::nullopt;
}

}  // namespace candela
