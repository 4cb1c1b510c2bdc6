#pragma once
#include <array>
#include <expected>
#include <string>
#include <vector>

#include "image/basis_codes.h"

// ETC1S, the smaller of Basis Universal's two codecs: blocks of 4x4 texels of one colour of 15 bits, made lighter and
// darker in four steps; colours and patterns of steps lie in codebooks, and slices are streams of indices into those
// (Khronos, KTX File Format Specification 2.0, "BasisLZ/ETC1S Bitstream"; Data Format Specification 1.3, "ETC1").
namespace candela {

struct Etc1sSections {
  uint32_t colour_count = 0, pattern_count = 0;
  std::span<const std::byte> colours, patterns, codes;
};

using Rgb8 = std::array<uint8_t, 3>;

class Etc1sDecoder {
 public:
  // Reads what the slices of a file share. Errors: what is wrong.
  static std::expected<Etc1sDecoder, std::string> make(const Etc1sSections& sections);
  // The texels of one slice, rows from the top. The caller has bounded the size.
  std::expected<std::vector<Rgb8>, std::string> slice(std::span<const std::byte> stream, uint32_t width,
                                                      uint32_t height) const;

 private:
  struct Colour {
    Rgb8 base;  // 5 bits each
    uint8_t contrast;
  };
  using Pattern = std::array<uint8_t, 4>;  // a row a byte, 2 bits a texel, the left one lowest

  std::string read_colours(const Etc1sSections& sections);
  std::string read_patterns(const Etc1sSections& sections);
  std::string read_codes(const Etc1sSections& sections);

  std::vector<Colour> colours_;
  std::vector<Pattern> patterns_;
  BasisCodes prediction_, colour_step_, pattern_, run_;
  uint32_t history_size_ = 0;

  friend class Etc1sSlice;
};

}  // namespace candela
