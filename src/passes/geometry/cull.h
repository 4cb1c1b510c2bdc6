#pragma once
#include "passes/pass.h"
#include "passes/scene_inputs.h"

namespace candela {

// Frustum culling of draw items on the GPU (TECHNIQUES 2.1), first half: counts the survivors of each group of 256
// items. Boxes are in relative space, five planes, NaN and infinite boxes are kept, rounding never culls. Nothing is
// approximated: the image with `enabled` = 0 is the same, bit for bit.
struct Cull {
  static constexpr std::string_view name = "cull";
  struct Knobs {
    static constexpr std::string_view name = "cull";
    int enabled = 1;
    static std::span<const Knob<Knobs>> table();
  };
  struct In {
    SceneInputs scene;
  };
  struct Out {
    BufferHandle survivors;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
