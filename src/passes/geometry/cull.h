#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

struct CullKnobs {
  static constexpr std::string_view name = "cull";
  int enabled = 1;
  static std::span<const Knob> table();
};

// Culling of draw items for a range of views on the GPU, first half: a bit for each view and item, and
// the survivors of each group of 256 items. Boxes and planes are in relative space; NaN and infinite boxes are kept,
// rounding never culls. Nothing is approximated: the image with `enabled` = 0 is the same, bit for bit; only a view's
// least_px leaves out what it would show (shaders/shared/cull.h).
struct Cull {
  static constexpr std::string_view name = "cull";
  using Knobs = CullKnobs;
  struct In {
    SceneInputs scene;
    ViewRange views{};  // the camera, if nothing else is said
  };
  struct Out {
    BufferHandle masks, survivors;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
