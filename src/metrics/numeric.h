#pragma once
#include <map>
#include <span>
#include <string>
#include <utility>

#include "image/image.h"

namespace candela {

// Float channels of the reference and of the image under test, of the same place and size.
using ChannelPair = std::pair<const Channel*, const Channel*>;

inline constexpr double relmse_epsilon = 0.01;  // added to the square of the reference in relmse
inline constexpr double trimmed_fraction =
    0.001;  // of the pixels, those with the largest error, which relmse-trimmed leaves out

struct Place {
  int x = 0, y = 0;
  std::string channel;  // empty: no pixel differs
};

// Differences of values as they are: max, mae, rmse, relmse, relmse-trimmed, and p50, p90, p99, p99.9 (compare.h says
// what they are). Sums are in double and in a fixed order. Places that are not finite in the reference (and then equal
// in the test image, or the pair would have been refused) count as no difference.
struct NumericResult {
  std::map<std::string, double> metrics;
  Place max_at;
};
NumericResult numeric_metrics(std::span<const ChannelPair> channels, int width, int height);

// Pixels that are not bit-equal in every channel, integers too.
double differing_pixels(std::span<const ChannelPair> channels, int width, int height);

// The value that the fraction of sorted values stays under, linear between ranks; 0 of nothing.
double sorted_percentile(std::span<const float> sorted, double fraction);

}  // namespace candela
