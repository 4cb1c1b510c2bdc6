#include "base/hash.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>

namespace candela {
namespace {
uint64_t final_mix(uint64_t k) {
  k = (k ^ (k >> 33)) * 0xff51afd7ed558ccdull;
  k = (k ^ (k >> 33)) * 0xc4ceb9fe1a85ec53ull;
  return k ^ (k >> 33);
}
constexpr uint64_t c1 = 0x87c37b91114253d5ull, c2 = 0x4cf5ad432745937full;
uint64_t mix1(uint64_t k) { return std::rotl(k * c1, 31) * c2; }
uint64_t mix2(uint64_t k) { return std::rotl(k * c2, 33) * c1; }
}  // namespace

Hash128 hash128(std::span<const std::byte> bytes, uint64_t seed) {
  uint64_t h1 = seed, h2 = seed;
  const size_t blocks = bytes.size() / 16;
  for (size_t i = 0; i < blocks; ++i) {
    uint64_t k[2];
    std::memcpy(k, bytes.data() + i * 16, 16);
    h1 = (std::rotl(h1 ^ mix1(k[0]), 27) + h2) * 5 + 0x52dce729;
    h2 = (std::rotl(h2 ^ mix2(k[1]), 31) + h1) * 5 + 0x38495ab5;
  }
  uint64_t k[2] = {0, 0};
  const size_t rest = bytes.size() - blocks * 16;
  if (rest) std::memcpy(k, bytes.data() + blocks * 16, rest);
  if (rest > 8) h2 ^= mix2(k[1]);
  if (rest > 0) h1 ^= mix1(k[0]);
  h1 ^= bytes.size();
  h2 ^= bytes.size();
  h1 += h2, h2 += h1;
  h1 = final_mix(h1), h2 = final_mix(h2);
  h1 += h2, h2 += h1;
  return {h1, h2};
}

uint32_t hash32(std::string_view text, uint32_t seed) {
  const auto mixed = [](uint32_t k) { return std::rotl(k * 0xcc9e2d51u, 15) * 0x1b873593u; };
  uint32_t h = seed;
  const size_t blocks = text.size() / 4;
  for (size_t i = 0; i <= blocks; ++i) {
    uint32_t k = 0;  // little-endian; the last block is what is left
    for (size_t b = 4 * i; b < std::min(4 * i + 4, text.size()); ++b)
      k |= uint32_t(static_cast<unsigned char>(text[b])) << (8 * (b - 4 * i));
    h ^= mixed(k);
    if (i < blocks) h = std::rotl(h, 13) * 5 + 0xe6546b64u;
  }
  h ^= uint32_t(text.size());
  h = (h ^ (h >> 16)) * 0x85ebca6bu;
  h = (h ^ (h >> 13)) * 0xc2b2ae35u;
  return h ^ (h >> 16);
}

std::string Hash128::hex() const { return fmt::format("{:016x}{:016x}", hi, lo); }
}  // namespace candela
