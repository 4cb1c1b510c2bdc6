#pragma once
#include <limits>

#include "bvh/build.h"
#include "bvh/simd.h"

namespace candela {

// An Aabb in vector registers, for the builders' inner loops. The fourth lanes hold zeros or nothing of meaning.
struct BuildBox {
  F4 low = F4::all(std::numeric_limits<float>::infinity()), high = F4::all(-std::numeric_limits<float>::infinity());
  void add(F4 l, F4 h) { low = min(low, l), high = max(high, h); }
  // The same, but NaNs leave the box as it is (simd.h's min and max).
  void grow(F4 l, F4 h) { low = min(l, low), high = max(h, high); }
  void add(const BuildBox& b) { add(b.low, b.high); }
  Aabb aabb() const {
    float l[4], h[4];
    low.store(l), high.store(h);
    return {{l[0], l[1], l[2]}, {h[0], h[1], h[2]}};
  }
  void write(BinaryNode& node) const {
    float l[4], h[4];
    low.store(l), high.store(h);
    for (int a = 0; a < 3; ++a) node.low[a] = l[a], node.high[a] = h[a];
  }
  // Half the surface; 0 for the empty box.
  float half_area() const {
    float e[4];
    (high - low).store(e);
    return e[0] >= 0 ? (e[0] * e[1] + e[1] * e[2]) + e[2] * e[0] : 0.0f;
  }
};

inline F4 low_of(const BoxReference& r) { return without_lane_3(F4::load(r.low)); }
inline F4 high_of(const BoxReference& r) { return F4::load(r.high); }
inline BuildBox box_of(const BoxReference& r) { return {low_of(r), high_of(r)}; }
// Twice the centre: what references are sorted by.
inline F4 centre2_of(const BoxReference& r) { return low_of(r) + high_of(r); }

// References of a node and what splits are made from.
struct Span {
  const BoxReference* references;
  uint32_t count;
  const BoxReference* begin() const { return references; }
  const BoxReference* end() const { return references + count; }
};

// What testing that many references costs, in tests of a block.
inline float tests_of(uint32_t count, uint32_t block_shift) {
  return float((count + ((1u << block_shift) - 1)) >> block_shift);
}

// Nodes above this size are binned by all threads; the sums (minima, maxima, counts) do not depend on their order.
constexpr uint32_t parallel_binning = 1u << 15;

}  // namespace candela
