#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"

namespace candela {

struct MaskKnobs {
  static constexpr std::string_view name = "masks";
  int by_sample = 0;
  static std::span<const Knob> table();
};

// Depth of all opaque and masked surfaces at every sample, reversed and infinite in 32-bit float, so
// that shading runs once for each visible fragment. Masked surfaces drop what their mask cuts away, at the pixel's
// shading point, or sample by sample (knob by_sample).
//
// refracting: of those and of surfaces that refract, for what is drawn over what is seen through them.
struct DepthPrepass {
  static constexpr std::string_view name = "depth_prepass";
  using Knobs = MaskKnobs;
  using SharedKnobs = std::tuple<TextureKnobs, ReliefKnobs>;  // of masks
  using InputKnobs = SampleCountKnobs;
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;     // optional
    ImageHandle depth;         // optional: of what is drawn already
    bool lines_alone = false;  // and points: without triangles
  };
  struct Out {
    ImageHandle depth;
    BatchPipelines pipelines;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  bool refracting = false;
  Knobs knobs;
};

}  // namespace candela
