#include "image/etc1s.h"

#include <algorithm>

namespace candela {

std::string Etc1sDecoder::read_colours(const Etc1sSections& sections) {
  BitReader bits(sections.colours);
  std::array<BasisCodes, 3> step;  // by how bright the colour before was
  BasisCodes contrast_step;
  for (BasisCodes* codes : {&step[0], &step[1], &step[2], &contrast_step})
    if (std::string damage = codes->read(bits); !damage.empty()) return damage;
  const bool grey = bits.take(1) != 0;
  Colour before{{16, 16, 16}, 0};
  for (uint32_t i = 0; i < sections.colour_count; ++i) {
    const uint32_t more = contrast_step.decode(bits);
    if (more == BasisCodes::none) return "the codebook of colours is damaged";
    before.contrast = uint8_t((before.contrast + more) & 7);
    for (size_t c = 0; c < (grey ? 1 : 3); ++c) {
      uint8_t& value = before.base[c];
      const uint32_t delta = step[value <= 9 ? 0 : value <= 21 ? 1 : 2].decode(bits);
      if (delta == BasisCodes::none) return "the codebook of colours is damaged";
      value = uint8_t((value + delta) & 31);
    }
    if (grey) before.base = {before.base[0], before.base[0], before.base[0]};
    colours_.push_back(before);
    if (bits.overrun()) return "the codebook of colours is truncated";
  }
  return {};
}

std::string Etc1sDecoder::read_patterns(const Etc1sSections& sections) {
  BitReader bits(sections.patterns);
  if (bits.take(2) != 0) return "the codebook of patterns has a reserved form";
  const bool plain = bits.take(1) != 0;
  BasisCodes change;
  if (std::string damage = plain ? std::string() : change.read(bits); !damage.empty()) return damage;
  Pattern pattern = {};
  for (uint32_t i = 0; i < sections.pattern_count; ++i) {
    for (uint8_t& row : pattern) {
      const uint32_t value = plain || i == 0 ? bits.take(8) : change.decode(bits);
      if (value > 255) return "the codebook of patterns is damaged";
      row = uint8_t(plain || i == 0 ? value : row ^ value);
    }
    patterns_.push_back(pattern);
    if (bits.overrun()) return "the codebook of patterns is truncated";
  }
  return {};
}

std::string Etc1sDecoder::read_codes(const Etc1sSections& sections) {
  BitReader bits(sections.codes);
  for (BasisCodes* codes : {&prediction_, &colour_step_, &pattern_, &run_})
    if (std::string damage = codes->read(bits); !damage.empty()) return damage;
  history_size_ = bits.take(13);
  return bits.overrun() ? "the tables of prefix codes are truncated" : "";
}

std::expected<Etc1sDecoder, std::string> Etc1sDecoder::make(const Etc1sSections& sections) {
  Etc1sDecoder decoder;
  if (sections.colour_count == 0 || sections.pattern_count == 0) return std::unexpected("a codebook is empty");
  for (const auto read : {&Etc1sDecoder::read_colours, &Etc1sDecoder::read_patterns, &Etc1sDecoder::read_codes})
    if (std::string damage = (decoder.*read)(sections); !damage.empty()) return std::unexpected(std::move(damage));
  return decoder;
}

// The indices of a slice's blocks, one after the other: colours by prediction from blocks before, patterns through a
// list of those used lately.
class Etc1sSlice {
 public:
  Etc1sSlice(const Etc1sDecoder& decoder, std::span<const std::byte> stream, uint32_t columns)
      : decoder_(decoder),
        bits_(stream),
        above_(columns),
        row_(columns),
        predicted_below_((columns + 1) / 2),
        history_(decoder.history_size_),
        newest_(decoder.history_size_ / 2) {}

  // Empty when all is well, else what is wrong.
  std::string next(uint32_t x, uint32_t y, uint32_t& colour, uint32_t& pattern) {
    if (x == 0) std::swap(above_, row_);
    if (std::string damage = next_colour(x, y, colour); !damage.empty()) return damage;
    if (std::string damage = next_pattern(pattern); !damage.empty()) return damage;
    row_[x] = last_colour_ = colour;
    return bits_.overrun() ? "a slice is truncated" : "";
  }

 private:
  // The predictions of two blocks by two, 2 bits each, the upper pair lowest.
  std::string next_predictions() {
    constexpr uint32_t repeat = 256, least_run = 3;
    if (predictions_left_ > 0) {
      --predictions_left_;
      return {};
    }
    const uint32_t symbol = decoder_.prediction_.decode(bits_);
    if (symbol > repeat) return "a prediction is damaged";
    if (symbol == repeat)
      predictions_left_ = uint64_t(run_of_groups(4)) + least_run - 1;
    else
      predictions_ = symbol;
    return {};
  }

  // A number in groups of bits, the lowest first; the bit above a group says that there is another.
  uint32_t run_of_groups(uint32_t group_bits) {
    uint32_t value = 0;
    for (uint32_t at = 0; at < 32; at += group_bits) {
      const uint32_t group = bits_.take(group_bits + 1);
      value |= (group & ((1u << group_bits) - 1)) << at;
      if (group >> group_bits == 0) break;
    }
    return value;
  }

  std::string next_colour(uint32_t x, uint32_t y, uint32_t& colour) {
    if (x % 2 == 0) {
      if (y % 2 == 0) {
        if (std::string damage = next_predictions(); !damage.empty()) return damage;
        predicted_ = predictions_;
        predicted_below_[x / 2] = uint8_t(predictions_ >> 4);
      } else {
        predicted_ = predicted_below_[x / 2];
      }
    }
    enum Prediction : uint32_t { left, above, above_left, step };
    const uint32_t prediction = predicted_ & 3;
    predicted_ >>= 2;
    const bool needs_left = prediction == left || prediction == above_left,
               needs_above = prediction == above || prediction == above_left;
    if ((needs_left && x == 0) || (needs_above && y == 0)) return "a block is predicted from one outside the image";
    switch (prediction) {
      case left:
        colour = last_colour_;
        break;
      case above:
        colour = above_[x];
        break;
      case above_left:
        colour = above_[x - 1];
        break;
      default: {
        const uint32_t symbol = decoder_.colour_step_.decode(bits_);
        if (symbol == BasisCodes::none) return "the index of a colour is damaged";
        colour = last_colour_ + symbol;
        if (colour >= decoder_.colours_.size()) colour -= uint32_t(decoder_.colours_.size());
      }
    }
    return colour < decoder_.colours_.size() ? "" : "the index of a colour is outside the codebook";
  }

  std::string next_pattern(uint32_t& pattern) {
    constexpr uint32_t least_run = 3, long_run = 63;
    const auto known = uint32_t(decoder_.patterns_.size());
    const uint32_t run_symbol = known + uint32_t(history_.size());
    uint32_t symbol = known;  // the first of the history
    if (patterns_left_ > 0) {
      --patterns_left_;
    } else {
      symbol = decoder_.pattern_.decode(bits_);
      if (symbol == run_symbol) {
        const uint32_t run = decoder_.run_.decode(bits_);
        if (run > long_run) return "a run of patterns is damaged";
        patterns_left_ = uint64_t(run == long_run ? run_of_groups(7) : run) + least_run - 1;
        symbol = known;
      }
    }
    if (symbol < known) {
      pattern = symbol;
      remember(pattern);
      return {};
    }
    const uint32_t at = symbol - known;
    if (symbol == BasisCodes::none || at >= history_.size()) return "the index of a pattern is damaged";
    pattern = history_[at];
    std::swap(history_[at], history_[at / 2]);
    return pattern < known ? "" : "the index of a pattern is outside the codebook";
  }

  // New ones go round in the second half; what is used again moves towards the front.
  void remember(uint32_t pattern) {
    if (history_.empty()) return;
    history_[newest_++] = pattern;
    if (newest_ == history_.size()) newest_ = history_.size() / 2;
  }

  const Etc1sDecoder& decoder_;
  BitReader bits_;
  std::vector<uint32_t> above_, row_;     // colours of the blocks of two rows
  std::vector<uint8_t> predicted_below_;  // predictions of the next row's pairs
  std::vector<uint32_t> history_;
  size_t newest_;
  uint32_t predictions_ = 0, predicted_ = 0, last_colour_ = 0;
  uint64_t predictions_left_ = 0, patterns_left_ = 0;  // of runs
};

std::expected<std::vector<Rgb8>, std::string> Etc1sDecoder::slice(std::span<const std::byte> stream, uint32_t width,
                                                                  uint32_t height) const {
  static constexpr int contrasts[8][2] = {{2, 8}, {5, 17}, {9, 29}, {13, 42}, {18, 60}, {24, 80}, {33, 106}, {47, 183}};
  const uint32_t columns = (width + 3) / 4, rows = (height + 3) / 4;
  std::vector<Rgb8> out(size_t(width) * height);
  Etc1sSlice blocks(*this, stream, columns);
  for (uint32_t y = 0; y < rows; ++y)
    for (uint32_t x = 0; x < columns; ++x) {
      uint32_t colour_index = 0, pattern_index = 0;
      if (std::string damage = blocks.next(x, y, colour_index, pattern_index); !damage.empty())
        return std::unexpected(std::move(damage));
      const Colour& colour = colours_[colour_index];
      const auto& [near, far] = contrasts[colour.contrast];
      const std::array<int, 4> steps = {-far, -near, near, far};
      std::array<Rgb8, 4> texels;
      for (size_t s = 0; s < 4; ++s)
        for (size_t c = 0; c < 3; ++c)
          texels[s][c] = uint8_t(std::clamp((colour.base[c] << 3 | colour.base[c] >> 2) + steps[s], 0, 255));
      for (uint32_t v = 0; v < std::min(4u, height - 4 * y); ++v)
        for (uint32_t u = 0; u < std::min(4u, width - 4 * x); ++u)
          out[size_t(4 * y + v) * width + 4 * x + u] = texels[patterns_[pattern_index][v] >> (2 * u) & 3];
    }
  return out;
}

}  // namespace candela
