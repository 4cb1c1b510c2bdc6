#include "plan/pack_nodes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace candela {
namespace {

constexpr double most_steps = 255;
constexpr int exponent_bias = 127;  // of floats

// The exponent, biased, of the least power of two of which 255 cover the width.
uint32_t step_exponent(double width) {
  int exponent = 1 - exponent_bias;
  if (width > 0) {
    std::frexp(width / most_steps, &exponent);  // width / 255 = m 2^exponent with m below 1
    if (std::ldexp(most_steps, exponent - 1) >= width) --exponent;
  }
  return uint32_t(std::clamp(exponent + exponent_bias, 1, 254));
}

// Which place each child takes.
std::array<uint32_t, wide_children> places(const WideNode& node) {
  double middle[3][wide_children], low[3], high[3];
  for (size_t a = 0; a < 3; ++a) {
    low[a] = INFINITY, high[a] = -INFINITY;
    for (size_t c = 0; c < wide_children; ++c) {
      if (node.child[c] == no_child) continue;
      middle[a][c] = 0.5 * (double(node.bounds[2 * a][c]) + double(node.bounds[2 * a + 1][c]));
      low[a] = std::min(low[a], double(node.bounds[2 * a][c]));
      high[a] = std::max(high[a], double(node.bounds[2 * a + 1][c]));
    }
  }
  std::array<uint32_t, wide_children> place{};
  uint32_t placed = 0, taken = 0;
  for (size_t c = 0; c < wide_children; ++c) placed |= node.child[c] == no_child ? 1u << c : 0;
  double gain[wide_children][wide_children];
  for (size_t c = 0; c < wide_children; ++c)
    for (size_t p = 0; p < wide_children; ++p) {
      gain[c][p] = 0;
      for (size_t a = 0; a < 3 && !(placed >> c & 1u); ++a) {
        const double aside = middle[a][c] - 0.5 * (low[a] + high[a]);
        gain[c][p] += p >> a & 1u ? aside : -aside;
      }
    }
  while (placed != 0xffu) {
    size_t best_child = wide_children, best_place = 0;
    for (size_t c = 0; c < wide_children; ++c) {
      if (placed >> c & 1u) continue;
      for (size_t p = 0; p < wide_children; ++p)
        if (!(taken >> p & 1u) && (best_child == wide_children || gain[c][p] > gain[best_child][best_place]))
          best_child = c, best_place = p;
    }
    place[best_child] = uint32_t(best_place);
    placed |= 1u << best_child, taken |= 1u << best_place;
  }
  return place;
}

}  // namespace

shared::TraceNode packed_node(const WideNode& node, uint32_t first_node, uint32_t first_leaf) {
  shared::TraceNode out{};
  uint32_t child[wide_children];
  std::fill_n(child, wide_children, no_child);
  const std::array<uint32_t, wide_children> place = places(node);
  for (size_t c = 0; c < wide_children; ++c) {
    const uint32_t from = node.child[c];
    if (from == no_child) continue;
    child[place[c]] = from + (from & leaf_bit ? first_leaf : first_node);
    out.steps |= 1u << (24 + place[c]);
  }
  std::memcpy(out.child, child, sizeof child);
  for (size_t a = 0; a < 3; ++a) {
    float low = INFINITY, high = -INFINITY;
    for (size_t c = 0; c < wide_children; ++c) {
      if (node.child[c] == no_child) continue;
      low = std::min(low, node.bounds[2 * a][c]);
      high = std::max(high, node.bounds[2 * a + 1][c]);
    }
    if (!(low <= high)) low = high = 0;  // an empty node
    const uint32_t exponent = step_exponent(double(high) - double(low));
    const double step = std::ldexp(1.0, int(exponent) - exponent_bias);
    out.low[int(a)] = low;
    out.steps |= exponent << (8 * a);
    uint8_t rows[2 * wide_children] = {};
    for (size_t c = 0; c < wide_children; ++c) {
      if (node.child[c] == no_child) continue;
      const double from = (double(node.bounds[2 * a][c]) - double(low)) / step;
      const double to = (double(node.bounds[2 * a + 1][c]) - double(low)) / step;
      rows[place[c]] = uint8_t(std::clamp(std::floor(from), 0.0, most_steps));
      rows[wide_children + place[c]] = uint8_t(std::clamp(std::ceil(to), 0.0, most_steps));
    }
    std::memcpy(&out.bounds[a], rows, sizeof rows);
  }
  return out;
}

}  // namespace candela
