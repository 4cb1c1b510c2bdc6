#include "image/uastc.h"

#include "image/bit_reader.h"

namespace candela {
namespace {

// The end colours of a mode are numbers of `bits` low bits and, above them, a digit of base 3 or 5 or nothing.
struct UastcRange {
  uint32_t bits, base;  // base 1: no digit
};

enum class UastcSets : uint8_t { none, two, three, two_of_three };  // lists of partitions

struct UastcMode {
  uint32_t code, code_bits;
  uint32_t weight_bits;
  UastcRange range;
  uint32_t components;  // 2: luminance and alpha
  uint32_t hint_bits;   // help for transcoders to other formats; not read
  UastcSets sets = UastcSets::none;
  bool two_planes = false;  // one component has weights of its own
};

// Mode 8 is one colour; after the last comes a code that is kept for the future.
constexpr UastcMode uastc_modes[] = {
    {0x01, 4, 4, {6, 3}, 3, 15},
    {0x35, 6, 2, {8, 1}, 3, 15},
    {0x1d, 5, 3, {4, 1}, 3, 15, UastcSets::two},
    {0x03, 5, 2, {2, 3}, 3, 15, UastcSets::three},
    {0x13, 5, 2, {3, 5}, 3, 15, UastcSets::two},
    {0x0b, 5, 3, {8, 1}, 3, 15},
    {0x1b, 5, 2, {5, 5}, 3, 15, UastcSets::none, true},
    {0x07, 5, 2, {3, 5}, 3, 15, UastcSets::two_of_three},
    {0x17, 5, 0, {8, 1}, 4, 0},
    {0x0f, 5, 2, {4, 1}, 4, 23, UastcSets::two},
    {0x02, 3, 4, {4, 3}, 4, 17},
    {0x00, 2, 2, {4, 3}, 4, 17, UastcSets::none, true},
    {0x06, 3, 3, {6, 3}, 4, 17},
    {0x1f, 5, 1, {8, 1}, 4, 23, UastcSets::none, true},
    {0x0d, 5, 2, {8, 1}, 4, 23},
    {0x05, 7, 4, {8, 1}, 2, 23},
    {0x15, 6, 2, {8, 1}, 2, 23, UastcSets::two},
    {0x25, 6, 2, {8, 1}, 2, 23, UastcSets::none, true},
    {0x09, 4, 5, {5, 1}, 3, 15},
};
constexpr uint32_t one_colour = 8;

// ASTC's partitions are made by a hash of a seed; these seeds give patterns that BC7 has too.
constexpr uint16_t two_set_seeds[] = {28, 20,  16,  29, 91,  9,   107, 72,  149, 204, 50,  114, 496, 17,  78,
                                      39, 252, 828, 43, 156, 116, 210, 476, 273, 684, 359, 246, 195, 694, 524};
constexpr uint16_t three_set_seeds[] = {260, 74, 32, 156, 183, 15, 745, 0, 335, 902, 254};
constexpr uint16_t two_of_three_seeds[] = {36,  48,  61,  137, 161, 183, 226, 281, 302, 307,
                                           479, 495, 593, 594, 605, 799, 812, 988, 993};

using UastcPattern = std::array<uint8_t, 16>;  // the set of each texel

// Data Format Specification 1.3, "Partition Pattern Generation", for blocks of 16 texels and two or three sets.
constexpr UastcPattern pattern_of(uint32_t seed, uint32_t sets) {
  seed += (sets - 1) * 1024;
  uint32_t n = seed;
  n ^= n >> 15, n -= n << 17, n += n << 7, n += n << 4, n ^= n >> 5;
  n += n << 16, n ^= n >> 7, n ^= n >> 3, n ^= n << 6, n ^= n >> 17;
  const uint32_t narrow = seed & 2 ? 4 : 5, wide = sets == 3 ? 6 : 5;
  const uint32_t along = seed & 1 ? narrow : wide, across = seed & 1 ? wide : narrow;
  const auto factor = [n](uint32_t at, uint32_t shift) {
    const uint32_t digit = n >> at & 15;
    return digit * digit >> shift;
  };
  UastcPattern out = {};
  for (uint32_t i = 0; i < 16; ++i) {
    const uint32_t x = i % 4 * 2, y = i / 4 * 2;  // small blocks are stretched
    const uint32_t a = (factor(0, along) * x + factor(4, across) * y + (n >> 14)) & 63,
                   b = (factor(8, along) * x + factor(12, across) * y + (n >> 10)) & 63,
                   c = sets < 3 ? 0 : (factor(16, along) * x + factor(20, across) * y + (n >> 6)) & 63;
    out[i] = a >= b && a >= c ? 0 : b >= c ? 1 : 2;
  }
  return out;
}

template <size_t Count>
constexpr std::array<UastcPattern, Count> patterns_of(const uint16_t (&seeds)[Count], uint32_t sets) {
  std::array<UastcPattern, Count> out = {};
  for (size_t i = 0; i < Count; ++i) out[i] = pattern_of(seeds[i], sets);
  return out;
}
constexpr auto two_sets = patterns_of(two_set_seeds, 2);
constexpr auto three_sets = patterns_of(three_set_seeds, 3);
constexpr auto two_of_three_sets = patterns_of(two_of_three_seeds, 2);

struct UastcList {
  std::span<const UastcPattern> patterns;
  uint32_t sets, index_bits;
};
UastcList list_of(UastcSets sets) {
  static constexpr UastcPattern whole[] = {{}};
  switch (sets) {
    case UastcSets::two:
      return {two_sets, 2, 5};
    case UastcSets::three:
      return {three_sets, 3, 4};
    case UastcSets::two_of_three:
      return {two_of_three_sets, 2, 5};
    default:
      return {whole, 1, 0};
  }
}

// The number as 0 to 255 (Data Format Specification 1.3, "Endpoint Unquantization").
uint32_t end_value(uint32_t digit, uint32_t low, UastcRange range) {
  if (range.base == 1) return range.bits == 8 ? low : range.bits == 5 ? low << 3 | low >> 2 : low * 17;
  const uint32_t flip = low & 1 ? 0x1ff : 0, rest = low >> 1;
  uint32_t offset = 0, factor = 0;
  switch (range.bits) {
    case 2:
      offset = rest * 0x116, factor = 93;
      break;
    case 3:
      offset = rest << 7 | rest << 1 | rest >> 1, factor = 26;
      break;
    case 4:
      offset = rest << 6 | rest, factor = 22;
      break;
    case 5:
      offset = rest << 5 | rest >> 3, factor = 6;
      break;
    default:
      offset = rest << 4 | rest >> 4, factor = 5;
  }
  const uint32_t value = (digit * factor + offset) ^ flip;
  return (flip & 0x80) | value >> 2;
}

// 0 to 64.
uint32_t weight_value(uint32_t code, uint32_t bits) {
  static constexpr uint32_t repeated[] = {0, 63, 21, 9, 0, 0};  // code times it: its bits again and again, 6 of them
  const uint32_t value = bits == 4 ? code << 2 | code >> 2 : bits == 5 ? code << 1 | code >> 4 : code * repeated[bits];
  return value > 32 ? value + 1 : value;
}

void read_ends(BitReader& bits, UastcRange range, std::span<uint32_t> ends) {
  std::array<uint32_t, 18> digits = {};
  // Digits lie together: 5 of base 3 in 8 bits, 3 of base 5 in 7; a shorter group at the end takes what it needs.
  static constexpr uint32_t width_3[] = {0, 2, 4, 5, 7, 8}, width_5[] = {0, 3, 5, 7};
  if (range.base > 1)
    for (size_t group = range.base == 3 ? 5 : 3, i = 0; i < ends.size(); i += group) {
      const size_t count = std::min(group, ends.size() - i);
      uint32_t packed = bits.take((range.base == 3 ? width_3 : width_5)[count]);
      for (size_t k = 0; k < count; ++k, packed /= range.base) digits[i + k] = packed % range.base;
    }
  for (size_t i = 0; i < ends.size(); ++i) ends[i] = end_value(digits[i], bits.take(range.bits), range);
}

uint8_t blend(uint32_t first, uint32_t second, uint32_t weight) {
  return uint8_t((first * 257 * (64 - weight) + second * 257 * weight + 32) >> 6 >> 8);
}

const UastcMode* mode_of(uint32_t first_byte) {
  for (const UastcMode& mode : uastc_modes)
    if ((first_byte & ((1u << mode.code_bits) - 1)) == mode.code) return &mode;
  return nullptr;
}

}  // namespace

bool decode_uastc(std::span<const std::byte, 16> block, UastcTexels& out) {
  const UastcMode* const mode = mode_of(uint32_t(block[0]));
  if (!mode) return false;
  BitReader bits(block);
  bits.take(mode->code_bits);
  if (mode == &uastc_modes[one_colour]) {
    std::array<uint8_t, 4> colour;
    for (uint8_t& value : colour) value = uint8_t(bits.take(8));
    out.fill(colour);
    return true;
  }
  bits.take(mode->hint_bits);
  const UastcList list = list_of(mode->sets);
  const uint32_t index = bits.take(list.index_bits);
  if (index >= list.patterns.size()) return false;
  const UastcPattern& set_of = list.patterns[index];
  // Luminance and alpha: the second plane is always alpha's.
  const uint32_t alone = !mode->two_planes ? 4 : mode->components == 2 ? 3 : bits.take(2);

  const uint32_t components = mode->components;
  std::array<uint32_t, 18> ends = {};  // by set, component, first and second
  read_ends(bits, mode->range, std::span(ends).first(size_t(list.sets) * components * 2));

  uint32_t seen = 0;  // sets: the first weight of each is below a half and has a bit less
  for (size_t texel = 0; texel < 16; ++texel) {
    const uint32_t set = set_of[texel];
    const uint32_t width = mode->weight_bits - (seen >> set & 1 ? 0 : 1);
    seen |= 1u << set;
    std::array<uint32_t, 2> weights;
    weights[0] = weight_value(bits.take(width), mode->weight_bits);
    weights[1] = mode->two_planes ? weight_value(bits.take(width), mode->weight_bits) : weights[0];
    for (uint32_t c = 0; c < 4; ++c) {
      const uint32_t component = components == 2 ? c / 3 : c;
      const uint32_t at = (set * components + component) * 2;
      out[texel][c] = component < components ? blend(ends[at], ends[at + 1], weights[c == alone]) : 255;
    }
  }
  return true;
}

}  // namespace candela
