#include "plan/pack_nodes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "base/rng.h"

namespace candela::frame_pack_nodes {
namespace {

struct Bounds {
  double low[3], high[3];
};
Bounds unpacked(const shared::TraceNode& node, size_t place) {
  Bounds out;
  for (size_t a = 0; a < 3; ++a) {
    const double step = std::ldexp(1.0, int(node.steps >> 8 * a & 255) - 127);
    uint8_t rows[16];
    std::memcpy(rows, &node.bounds[a], sizeof rows);
    out.low[a] = double(node.low[int(a)]) + step * rows[place];
    out.high[a] = double(node.low[int(a)]) + step * rows[8 + place];
  }
  return out;
}
uint32_t child_at(const shared::TraceNode& node, size_t place) {
  uint32_t child[8];
  std::memcpy(child, node.child, sizeof child);
  return child[place];
}

}  // namespace

// Boxes hold those of the node and are no more than two steps wider; each child stands once, with its number raised.
TEST(PackedNodes, HoldTheirChildrensBoxes) {
  Rng rng(5);
  for (int round = 0; round < 2000; ++round) {
    WideNode node{};
    const double size = std::exp2(rng.uniform(-60, 60)), middle = rng.uniform(-1, 1) * std::exp2(rng.uniform(-40, 60));
    const size_t count = 1 + size_t(rng.uniform() * 8);
    double low[3], high[3];
    for (size_t a = 0; a < 3; ++a) low[a] = 1e300, high[a] = -1e300;
    for (size_t c = 0; c < wide_children; ++c) {
      node.child[c] = c >= count ? no_child : c % 2 ? leaf_child(uint32_t(7 + c), 2) : uint32_t(100 + c);
      for (size_t a = 0; a < 3; ++a) {
        const double p = middle + size * rng.uniform(-1, 1), q = round % 7 == 0 ? p : p + size * rng.uniform();
        node.bounds[2 * a][c] = c < count ? float(p) : std::numeric_limits<float>::infinity();
        node.bounds[2 * a + 1][c] = c < count ? float(std::max(q, double(float(p)))) : -INFINITY;
        if (c >= count) continue;
        low[a] = std::min(low[a], double(node.bounds[2 * a][c]));
        high[a] = std::max(high[a], double(node.bounds[2 * a + 1][c]));
      }
    }
    const shared::TraceNode packed = packed_node(node, 1000, 50);
    uint32_t seen = 0;
    for (size_t place = 0; place < 8; ++place) {
      const uint32_t child = child_at(packed, place);
      EXPECT_EQ(child != no_child, (packed.steps >> (24 + place) & 1) != 0);
      if (child == no_child) continue;
      const size_t c = child & leaf_bit ? first_of_leaf(child) - 57 : child - 1100;
      ASSERT_LT(c, count);
      EXPECT_EQ(seen & 1u << c, 0u);
      seen |= 1u << c;
      const Bounds box = unpacked(packed, place);
      for (size_t a = 0; a < 3; ++a) {
        const double step = std::ldexp(1.0, int(packed.steps >> 8 * a & 255) - 127);
        EXPECT_LE(box.low[a], double(node.bounds[2 * a][c]));
        EXPECT_GE(box.high[a], double(node.bounds[2 * a + 1][c]));
        EXPECT_LE(double(node.bounds[2 * a][c]) - box.low[a], step);
        EXPECT_LE(box.high[a] - double(node.bounds[2 * a + 1][c]), step);
        EXPECT_LE(step, std::max((high[a] - low[a]) / 127, 2.4e-38));
      }
    }
    EXPECT_EQ(seen, (1u << count) - 1);
  }
}

// Eight children in the corners of a cube stand where their corners' bits say.
TEST(PackedNodes, ChildrenStandWhereTheyLie) {
  WideNode node{};
  for (uint32_t c = 0; c < 8; ++c) {
    const uint32_t corner = c ^ 5;  // in another order
    node.child[c] = corner;
    for (uint32_t a = 0; a < 3; ++a) {
      const float at = corner >> a & 1 ? 3.0f : 0.0f;
      node.bounds[2 * a][c] = at, node.bounds[2 * a + 1][c] = at + 1;
    }
  }
  const shared::TraceNode packed = packed_node(node, 0, 0);
  for (uint32_t place = 0; place < 8; ++place) EXPECT_EQ(child_at(packed, place), place);
}

}  // namespace candela::frame_pack_nodes
