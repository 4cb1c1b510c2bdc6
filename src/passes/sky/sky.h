#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"

namespace candela {

// The environment image behind everything, where depth is 0 (infinity). Equirectangular, trilinear; linear radiance
// times pre-exposure. Free of motion under camera translation. Leaves wrong: level of detail ignores the mapping's
// stretch at the poles.
struct Sky {
  static constexpr std::string_view name = "sky";
  struct In {
    SceneInputs scene;
    ImageHandle depth;      // optional
    ImageHandle color;      // optional
    Lighting lists;         // of the fog that it is seen through
    bool fog_glows = true;  // otherwise the light of fog is left out, as it is no part of this term
  };
  struct Out {
    ImageHandle color;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
