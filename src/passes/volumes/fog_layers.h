#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"

namespace candela {

// What fog does to beauty, in images of their own: the light that it scatters or emits towards the camera, which with
// the terms of passes/surfaces/terms.h sums to beauty, and its transmittance, 1 in clear air. Drawn at the samples of
// beauty and against its depth, and blended surfaces composite over them as they do over beauty.
struct FogLayers {
  static constexpr std::string_view name = "fog_layers";
  static constexpr std::string_view effect = "fog";
  static constexpr LayerName layers[2] = {
      {"fog", "light that fog sends towards the camera"},
      {"fog_transmittance", "the fraction of light that fog lets through, a colour", LayerForm::color}};
  using SharedKnobs = std::tuple<LightRangeKnobs, TextureKnobs, ReliefKnobs>;
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;  // optional
    Lighting lists;         // with the fog
    ImageHandle depth;      // optional: there are blended surfaces alone without it
    std::array<bool, 2> wanted{};
    ImageHandle nearest;           // optional: depth of surfaces that refract too
    bool without_blended = false;  // passes behind this one draw blended surfaces over each layer
  };
  struct Out {
    std::array<ImageHandle, 2> images;  // as multisampled as the frame; empty where not wanted
    PipelineHandle behind;
    BatchPipelines opaque, blended;
  };
  // The shader of one layer alone, for Fragments::part.
  static std::string_view stored_part(size_t layer) {
    return layer == 0 ? "fog_layers.frag#LIGHT=0#TERM=out_light"
                      : "fog_layers.frag#TRANSMITTANCE=0#TERM=out_transmittance";
  }
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
