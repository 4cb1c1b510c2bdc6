#pragma once
#include "passes/shadows/shadow_layer_inputs.h"
#include "passes/shared/pass.h"

namespace candela {

// Of the nearest opaque or masked surface at the pixel's centre: `shadow`, the fraction of the directional lights'
// light that arrives, each weighed by its illuminance and cosine, 1 where none faces it; and which cascade tells it for
// the brightest light: `debug_cascades`, 1 the finest, 0 none. Lights without maps count as unblocked. Background: 1
// and 0.
struct SunLayers {
  static constexpr std::string_view name = "sun_layers";
  static constexpr LayerName layers[2] = {
      {"shadow_sun", "the fraction of the directional lights' light that arrives", LayerForm::fraction},
      {"debug_cascades", "which cascade of shadow maps the point takes; 0: none", LayerForm::count}};
  using In = ShadowLayerInputs;
  struct Out {
    std::array<ImageHandle, 2> images;
    NearestSurface drawn;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
