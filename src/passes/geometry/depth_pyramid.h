#pragma once
#include "passes/geometry/occlusion_cull_knobs.h"
#include "passes/shared/sampled_depth.h"

namespace candela {

// A pyramid of farthest depths (Greene, Kass, Miller, "Hierarchical Z-Buffer Visibility", 1993), reversed, so the
// least: the first level has a texel for 2x2 pixels, each other one for 2x2 of the level before; of a multisampled
// depth all samples count. Its sides are padded so that every level is exactly half the one before, and no row is lost
// with any size of the picture; texels of the padding hold the nearest depth, 1. It ends where four texels a side are
// all.
struct DepthPyramid {
  static constexpr std::string_view name = "depth_pyramid";
  using Knobs = OcclusionCullKnobs;
  struct In {
    BufferHandle constants;
    SampledDepth depth;
    uint32_t width_px = 0, height_px = 0, samples = 1;
  };
  struct Out {
    ImageHandle pyramid;
    struct {
      PipelineHandle first, others;
    } pipelines;
  };
  Need needed(const SceneFacts& facts, const FrameRequest&) const { return needs_occlusion_culling(facts, knobs); }
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
