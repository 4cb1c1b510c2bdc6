#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

struct SampleStoreKnobs {
  static constexpr std::string_view name = "sample_store";
  enum In : int { automatic, image, buffer };
  int in = automatic;
  static std::span<const Knob> table();
};

// Not a pass: the colour of each sample that a pass in compute shades and others draw over: an image that it stores
// into, or, where the device has no multisampled storage images, a buffer of vec4, which PutSamples makes an image of.
struct SampleStore {
  ImageHandle color;
  BufferHandle buffer;
};
// Completes the pass's shader (shaders/lib/store_samples.glsl).
SampleStore declare_sample_store(GraphBuilder& builder, const SceneInputs& scene, std::string_view pass,
                                 std::string& shader);
void push_sample_store(CommandList& commands, const SampleStore& store, OwnInputs& own);

}  // namespace candela
