#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

struct SupersampleKnobs {
  static constexpr std::string_view name = "supersample";
  int n = 1;
  int rows = 0;
  glm::uvec2 grid() const { return {uint32_t(n), uint32_t(rows > 0 ? rows : n)}; }
  uint32_t pictures() const { return grid().x * grid().y; }
  static std::span<const Knob> table();
};

// The exact end of edges, mips and filters: n x n whole pictures of the surfaces, each moved by a part of a pixel and
// with texture footprints of a pixel's n-th part, and their mean. That is a regular grid of n x n samples a pixel of
// position, texture and shading under a box filter; it takes the place of multisampling. With `rows` the grid has n
// columns and so many rows (4 by 2: eight samples), and footprints are as wide as the root of a sample's area. The pass
// adds one picture to the mean of those before it. Leaves wrong: what varies within a sample's fraction of the pixel,
// as 1/n to 1/n^2.
struct Supersample {
  static constexpr std::string_view name = "supersample";
  using Knobs = SupersampleKnobs;
  struct In {
    ImageHandle color;   // of this sample
    ImageHandle before;  // optional: the sum of the samples before it
    uint32_t width_px = 0, height_px = 0;
  };
  struct Out {
    ImageHandle sum;
    PipelineHandle pipeline;
  };
  bool ignores(std::string_view knob) const { return knob == "rows" && knobs.rows == 0; }  // as n then
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

// Where sample `index` of columns and rows lies against the middle of its pixel, in pixels: right and down.
inline glm::dvec2 subsample_offset_px(glm::uvec2 grid, uint32_t index) {
  return {(index % grid.x + 0.5) / grid.x - 0.5, (index / grid.x + 0.5) / grid.y - 0.5};
}

}  // namespace candela
