#pragma once
#include "passes/shared/blended.h"

namespace candela {

// Blended surfaces in any order, by moments of what they absorb along each sample's ray (Muenstermann, Krumpen, Klein
// and Peters, "Moment-Based Order-Independent Transparency", 2018). A first draw sums each surface's absorbance
// -ln(1 - coverage), and that times the first powers of its depth, which is warped to [-1, 1] by its logarithm between
// the nearest and the farthest blended bounds. A second draw shades: each surface is dimmed by the transmittance before
// it that the moments tell, and the sum, brought to what all together cover, lies over what is behind them. 32-bit sums
// in the order of drawing, which one device keeps; another order differs by rounding.
//
// Exact for one surface, and in how much of what is behind is seen. Leaves wrong: the transmittance in between, a
// smooth curve where there are many steps; more moments bend it better. A pixel's samples share one curve where one
// surface covers them.
struct Moments {
  static constexpr std::string_view name = "moments", method = "moments";
  struct Knobs {
    static constexpr std::string_view name = "moments";
    int count = 4;
    static std::span<const Knob> table();
  };
  using SharedKnobs = BlendedKnobs;
  using In = BlendedIn;
  struct Out {
    ImageHandle color;
    std::vector<ImageHandle> moments;  // the first four; absorbance and the fifth to seventh; the eighth
    ImageHandle sum;                   // of dimmed radiance and coverage
    BatchPipelines absorbed, drawn;
    PipelineHandle over;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
