#include "passes/shared/bvh_knobs.h"

namespace candela {

std::span<const Knob> BvhKnobs::table() {
  static const Knob rows[] = {
      {.name = "traversal",
       .member = &BvhKnobs::traversal,
       .lowest = 0,
       .highest = 2,
       .levels = {},
       .description =
           "who finds what rays meet: shaders, by the trees of bvh.builder; the device, asked by any shader that "
           "sends rays (query), or by a pipeline for the camera's rays alone",
       .choices = {"shader", "query", "pipeline"},
       .kind = Trades::time,
       .sweep = {1, 2, 0}},
      {.name = "builder",
       .member = &BvhKnobs::builder,
       .lowest = 0,
       .highest = 3,
       .levels = {},
       .description =
           "trees of rays: halves by count, by surface areas, by those and splits of space, or by splits alone; "
           "time to build against time to trace",
       .choices = {"equal-counts", "sah", "sbvh", "spatial-only"},
       .kind = Trades::time,
       .sweep = {0, 2, 1}},
      {.name = "buckets",
       .member = &BvhKnobs::buckets,
       .lowest = 2,
       .highest = 64,
       .levels = {},
       .description = "planes that a split by surface areas tries on each axis, less one",
       .kind = Trades::time,
       .sweep = {12, 32}},
      {.name = "max_leaf",
       .member = &BvhKnobs::max_leaf,
       .lowest = 1,
       .highest = 128,
       .levels = {},
       .description = "triangles in a leaf at most",
       .kind = Trades::time,
       .sweep = {1, 4, 8}},
      {.name = "block",
       .member = &BvhKnobs::block,
       .lowest = 0,
       .highest = 3,
       .levels = {},
       .description = "triangles that the builder takes to be tested for the price of one: 1, 2, 4, 8 as 0, 1, 2, 3",
       .kind = Trades::time,
       .sweep = {0, 2}},
      {.name = "node_cost",
       .member = &BvhKnobs::node_cost,
       .lowest = 0,
       .highest = 100,
       .levels = {},
       .description = "what the builder takes a step down to cost, in tests",
       .kind = Trades::time,
       .sweep = {0.125, 0.5}},
      {.name = "depth",
       .member = &BvhKnobs::depth,
       .lowest = 0,
       .highest = 60,
       .levels = {},
       .description = "steps down below which nodes are halved by count",
       .kind = Trades::time,
       .sweep = {0, 8, 16, 60}},
      {.name = "budget",
       .member = &BvhKnobs::budget,
       .lowest = 0,
       .highest = 16,
       .levels = {},
       .description = "references that splits of space may add, as a fraction of the triangles",
       .kind = Trades::time,
       .sweep = {0, 0.25, 1},
       .required = "bvh.builder=sbvh"},
      {.name = "repeated",
       .member = &BvhKnobs::repeated,
       .lowest = 0,
       .highest = 1 << 28,
       .levels = {},
       .description =
           "triangles that lie in the tree again for each item that shares them, beyond the first copies; of "
           "more, shared geometry has a tree of its own, which takes less memory and time to build, and "
           "more to trace",
       .kind = Trades::time,
       .sweep = {0, 1 << 19}},
  };
  return rows;
}

}  // namespace candela
