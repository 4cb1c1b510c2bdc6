#pragma once
#include "passes/shared/pass.h"

namespace candela {

// The picture darker towards its corners: times 1 - strength r^power, r the distance from the middle, 1 in a corner.
// Linear radiance in and out. A look: lenses fall off with the fourth power of the cosine instead.
struct Vignette {
  static constexpr std::string_view name = "vignette";
  static constexpr LayerName layers[] = {{"vignette", "what is left of the light in each pixel", LayerForm::fraction}};
  struct Knobs {
    static constexpr std::string_view name = "vignette";
    float strength = 0.5f, power = 2;
    static std::span<const Knob> table();
  };
  struct In {
    ImageHandle linear;
    uint32_t width_px = 0, height_px = 0;
  };
  struct Out {
    ImageHandle color, left;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
