#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

struct ResolveKnobs {
  static constexpr std::string_view name = "resolve";
  int samples = 4;
  static std::span<const Knob> table();
};

// The mean of a pixel's samples, in linear radiance: what a box pixel filter asks for, and what the EXR holds.
// Leaves wrong: edges against very bright surfaces look aliased after tone mapping.
struct Resolve {
  static constexpr std::string_view name = "resolve";
  using Knobs = ResolveKnobs;
  using InputKnobs = std::tuple<SupersampleKnobs>;
  struct In {
    ImageHandle color;
    uint32_t width_px = 0, height_px = 0, samples = 1;
  };
  struct Out {
    ImageHandle resolved;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
