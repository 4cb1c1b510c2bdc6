#include "image/basis_codes.h"

namespace candela {

std::string BasisCodes::assign(const std::vector<uint8_t>& lengths) {
  count_ = {};
  symbols_.clear();
  uint32_t space = 0;  // of 1 << longest
  for (uint8_t length = 1; length <= longest; ++length)
    for (size_t symbol = 0; symbol < lengths.size(); ++symbol)
      if (lengths[symbol] == length) {
        symbols_.push_back(uint16_t(symbol));
        ++count_[length];
        space += 1u << (longest - length);
        if (space > 1u << longest) return "a table of prefix codes has more codes than there are";
      }
  // A code of one symbol leaves the other half unused.
  if (space < 1u << longest && symbols_.size() > 1) return "a table of prefix codes has fewer codes than there are";
  return {};
}

uint32_t BasisCodes::decode(BitReader& bits) const {
  uint32_t code = 0, first = 0, before = 0;  // first code of this length; codes of smaller lengths
  for (uint32_t length = 1; length <= longest; ++length) {
    code |= bits.take(1);
    if (code - first < count_[length]) return symbols_[before + code - first];
    before += count_[length];
    first = (first + count_[length]) << 1;
    code <<= 1;
  }
  return none;
}

std::string BasisCodes::read(BitReader& bits) {
  constexpr uint32_t most_lengths = 21, first_run = 17;
  constexpr std::array<uint8_t, most_lengths> order = {17, 18, 19, 20, 0,  8, 7,  9, 6,  10, 5,
                                                       11, 4,  12, 3,  13, 2, 14, 1, 15, 16};
  struct Run {
    uint32_t bits, least;
    bool repeats;  // the length before; else zeros
  };
  constexpr Run runs[] = {{3, 3, false}, {7, 11, false}, {2, 3, true}, {7, 7, true}};

  const uint32_t size = bits.take(14), given = bits.take(5);
  if (size == 0) return assign({});
  if (given == 0 || given > most_lengths) return "a table of prefix codes has no lengths";
  std::vector<uint8_t> lengths(most_lengths);
  for (uint32_t i = 0; i < given; ++i) lengths[order[i]] = uint8_t(bits.take(3));
  BasisCodes of_lengths;
  if (std::string damage = of_lengths.assign(lengths); !damage.empty()) return damage;

  lengths.clear();
  while (lengths.size() < size) {
    const uint32_t symbol = of_lengths.decode(bits);
    if (symbol == none || bits.overrun()) return "a table of prefix codes ends early";
    if (symbol < first_run) {
      lengths.push_back(uint8_t(symbol));
      continue;
    }
    const Run& run = runs[symbol - first_run];
    const uint32_t count = run.least + bits.take(run.bits);
    const uint8_t length = run.repeats && !lengths.empty() ? lengths.back() : 0;
    if (count > size - lengths.size() || (run.repeats && length == 0))
      return "a run of lengths of prefix codes goes too far";
    lengths.insert(lengths.end(), count, length);
  }
  return assign(lengths);
}

}  // namespace candela
