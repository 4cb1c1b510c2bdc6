#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// Each light's box of cells, where the host has not posed the lights: what passes/lights/light_grid.cpp does for those
// that it has, by the same formulas in double. Boxes and chunks come in the order of threads, which no list shows:
// light_sort and bitmasks have the order of lights. Lights without range get none: they are lights of every cell.
struct LightBoundsPass {
  static constexpr std::string_view name = "light_bounds";
  using InputKnobs = std::tuple<LightKnobs>;
  struct In {
    SceneInputs scene;
  };
  struct Out {
    LightBoxes boxes;
    BufferHandle count;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  LightGridShape grid;
};

}  // namespace candela
