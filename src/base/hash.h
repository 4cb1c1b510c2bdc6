#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace candela {

// A 128-bit content hash (MurmurHash3 x64_128 by Austin Appleby, public domain algorithm; not cryptographic). Used as
// the key of caches and as the identity of jobs, plans and frames.
struct Hash128 {
  uint64_t lo = 0, hi = 0;
  bool operator==(const Hash128&) const = default;
  auto operator<=>(const Hash128&) const = default;
  std::string hex() const;  // 32 digits
};
Hash128 hash128(std::span<const std::byte> bytes, uint64_t seed = 0);
inline Hash128 hash128(std::string_view text, uint64_t seed = 0) {
  return hash128(std::as_bytes(std::span(text.data(), text.size())), seed);
}
// MurmurHash3 x86_32 of the same author: what file formats ask for (Cryptomatte).
uint32_t hash32(std::string_view text, uint32_t seed = 0);

}  // namespace candela
