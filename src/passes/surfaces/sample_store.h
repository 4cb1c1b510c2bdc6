#pragma once
#include "passes/geometry/draw_runs.h"
#include "passes/pass.h"
#include "passes/scene_inputs.h"

namespace candela {

struct SampleStoreKnobs {
  static constexpr std::string_view name = "sample_store";
  enum In : int { automatic, image, buffer };
  int in = automatic;
  static std::span<const Knob<SampleStoreKnobs>> table();
};

// The colour of each sample that a pass in compute shades and others draw over: an image that it stores into, or, where
// the device has no multisampled storage images, a buffer of vec4, which PutSamples makes an image of.
struct SampleStore {
  ImageHandle color;
  BufferHandle buffer;
};
// Completes the pass's shader (shaders/lib/store_samples.glsl).
SampleStore declare_sample_store(GraphBuilder& builder, const SceneInputs& scene, std::string_view pass,
                                 std::string& shader);
void push_sample_store(CommandList& commands, const SampleStore& store, OwnInputs& own);

struct PutSamples {
  static constexpr std::string_view name = "put_samples";
  using SharedKnobs = std::tuple<SampleStoreKnobs>;
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
