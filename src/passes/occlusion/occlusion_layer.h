#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"

namespace candela {

// Of the nearest opaque or masked surface at the pixel's centre: `occlusion`, the fraction of the sky's diffuse light
// that near surfaces leave, as shading reads it; 1 on unlit surfaces and where there is none.
struct OcclusionLayer {
  static constexpr std::string_view name = "occlusion_layer";
  static constexpr LayerName layers[] = {
      {"occlusion", "the fraction of the sky's light that is open: ambient occlusion", LayerForm::fraction}};
  using SharedKnobs = std::tuple<TextureKnobs, ReliefKnobs>;  // of masks
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;      // optional
    OcclusionTexels occlusion;  // optional: nothing is opaque or masked
    TracedRays rays;            // where it is traced
  };
  struct Out {
    ImageHandle layer;
    NearestSurface drawn;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
