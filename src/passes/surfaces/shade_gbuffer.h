#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"
#include "passes/surfaces/gbuffer_images.h"
#include "passes/surfaces/sample_store.h"

namespace candela {

// Radiance of what a G-buffer holds, in compute, by the same functions as ShadeForward and ShadeUnlit: of a pixel's
// samples those that hold the same bits once; what pixels with edges have more of is put into a list of their tile,
// which all its threads share. Units: cd/m2 times the pre-exposure. A colour for each sample.
struct ShadeGBuffer {
  static constexpr std::string_view name = "shade_gbuffer";
  using SharedKnobs = decltype(std::tuple_cat(GBufferShadingKnobs{}, std::tuple<SampleStoreKnobs>{}));
  static constexpr std::array<std::string_view, 2> shading_effects = {"ibl", "probes"};  // image-based light
  struct In {
    SceneInputs scene;
    GBufferImages gbuffer;
    Lighting lists;         // empty: every light for every pixel
    BufferHandle deformed;  // optional; of reliefs
  };
  struct Out {
    SampleStore samples;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
