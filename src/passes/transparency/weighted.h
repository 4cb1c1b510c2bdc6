#pragma once
#include "passes/shared/blended.h"

namespace candela {

// Blended surfaces by weighted sums, in one draw and any order (McGuire and Bavoil, "Weighted Blended
// Order-Independent Transparency", 2013, the weight of equation 9): a pixel gets the mean of what covers it, each
// surface by its coverage times a weight that falls with its distance in metres, over what lies behind, as far as all
// together cover it. Sums are 32-bit floats, added in the order of drawing, which one device keeps; another order
// differs by rounding.
//
// Exact for one surface, and for several of one colour. Leaves wrong: surfaces of different colours mix more evenly
// than they should, and what lies behind a dense one shines through it.
struct Weighted {
  static constexpr std::string_view name = "weighted", method = "weighted";
  using SharedKnobs = BlendedKnobs;
  using In = BlendedIn;
  struct Out {
    ImageHandle color;
    ImageHandle sum, absorbed;  // of weighted radiance and weights; of absorbance
    BatchPipelines drawn;
    PipelineHandle over;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
