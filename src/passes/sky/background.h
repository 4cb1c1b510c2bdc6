#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"

namespace candela {

// One colour behind everything, where no sky is: over the samples that no surface covers, at depth 0 (infinity), or all
// over an image that nothing has drawn into. Drawn instead of cleared: clearing four samples of 16 bytes takes llvmpipe
// as long as a quarter of the frame, and is then drawn over.
struct Background {
  static constexpr std::string_view name = "background";
  struct In {
    SceneInputs scene;
    ImageHandle depth;      // optional: of what has been drawn
    ImageHandle color;      // optional: what has been drawn
    Lighting lists;         // of the fog that it is seen through
    bool fog_glows = true;  // otherwise the light of fog is left out, as it is no part of this term
  };
  struct Out {
    ImageHandle color;
    PipelineHandle pipeline;  // empty: the image is cleared
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
