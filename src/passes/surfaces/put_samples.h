#pragma once
#include "passes/shared/pass.h"
#include "passes/surfaces/sample_store.h"

namespace candela {

// Samples that compute has left in a buffer as an image that passes draw over.
struct PutSamples {
  static constexpr std::string_view name = "put_samples";
  using SharedKnobs = std::tuple<SampleStoreKnobs>;
  using InputKnobs = SampleCountKnobs;
  struct In {
    SceneInputs scene;
    SampleStore samples;  // in a buffer
  };
  struct Out {
    ImageHandle color;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts&, const FrameRequest&) const { return {}; }
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
