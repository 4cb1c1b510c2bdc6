#pragma once
#include <array>
#include <string>
#include <vector>

#include "image/bit_reader.h"

namespace candela {

// Canonical prefix codes of up to 16 bits as BasisLZ stores them: the lengths are run-length and prefix coded in turn,
// as in deflate (Khronos, KTX File Format Specification 2.0, "BasisLZ/ETC1S Bitstream"; RFC 1951, 3.2).
class BasisCodes {
 public:
  // Empty when all is well, else what is wrong.
  std::string read(BitReader& bits);
  // A symbol, or none: no code is like these bits.
  static constexpr uint32_t none = ~0u;
  uint32_t decode(BitReader& bits) const;

 private:
  std::string assign(const std::vector<uint8_t>& lengths);

  static constexpr uint32_t longest = 16;
  std::array<uint32_t, longest + 1> count_ = {};  // codes of each length
  std::vector<uint16_t> symbols_;                 // by length, then by value
};

}  // namespace candela
