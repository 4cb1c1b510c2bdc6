#pragma once
#include <span>
#include <string_view>

#include "base/knob.h"

namespace candela {

// How the trees that rays go through are built (bvh/options.h, whose defaults these are), and who goes through them:
// the knobs `bvh.*`. They change times, and hits only where two are equally near.
struct BvhKnobs {
  static constexpr std::string_view name = "bvh";
  enum : int { equal_counts, sah, sbvh, spatial_only };
  enum : int { by_shader, by_query, by_pipeline };
  int traversal = by_shader;
  int builder = sah;
  int buckets = 32;
  int max_leaf = 8;
  int block = 2;
  float node_cost = 0.5f;
  int depth = 60;
  float budget = 1;
  int repeated = 1 << 19;
  // The device's own trees are built beside these.
  bool on_device() const { return traversal != by_shader; }
  static std::span<const Knob> table();
  bool operator==(const BvhKnobs&) const = default;
};

}  // namespace candela
