#pragma once
#include "passes/shadows/shadow_layer_inputs.h"
#include "passes/shared/pass.h"

namespace candela {

// Of the nearest opaque or masked surface at the pixel's centre: `shadow_local`, the fraction of the point and spot
// lights' light that arrives, each weighed by its illuminance and cosine, 1 where none reaches it. Lights without maps
// count as unblocked. Background: 1.
struct LocalLayers {
  static constexpr std::string_view name = "local_layers";
  static constexpr LayerName layers[1] = {
      {"shadow_local", "the fraction of point and spot lights' light that arrives", LayerForm::fraction}};
  using In = ShadowLayerInputs;
  struct Out {
    ImageHandle image;
    NearestSurface drawn;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
