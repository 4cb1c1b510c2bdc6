#pragma once
#include "passes/pass.h"
#include "passes/scene_inputs.h"

namespace candela {

// The exact end of edges, mips and filters: n x n whole pictures of the surfaces, each moved by a part of a pixel and
// with texture footprints of a pixel's n-th part, and their mean. That is a regular grid of n x n samples a pixel of
// position, texture and shading under a box filter; it takes the place of multisampling. The pass adds one picture to
// the mean of those before it. Leaves wrong: what varies within a sample's share of the pixel, as 1/n to 1/n^2.
struct Supersample {
  static constexpr std::string_view name = "supersample";
  struct Knobs {
    static constexpr std::string_view name = "supersample";
    int n = 1;
    static std::span<const Knob<Knobs>> table();
  };
  struct In {
    ImageHandle color;   // of this sample
    ImageHandle before;  // optional: the sum of the samples before it
    uint32_t width_px = 0, height_px = 0;
  };
  struct Out {
    ImageHandle sum;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

// Where sample `index` of n x n lies against the middle of its pixel, in pixels: right and down.
inline glm::dvec2 subsample_offset_px(uint32_t n, uint32_t index) {
  return {(index % n + 0.5) / n - 0.5, (index / n + 0.5) / n - 0.5};
}

}  // namespace candela
