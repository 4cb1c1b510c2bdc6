#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// Which lights can touch which cells of the light grid: one thread a light and cell of the box of cells round the
// light, so the cost follows what the lights cover, not lights times cells. The bounding test is a knob; all of them
// err towards yes, so no picture depends on it: boxes (Harada 2012), cone against sphere (Wronski 2017), tapered
// capsules. On a CPU compact lists are made by segments: the lights' chunks in order, cut into
// light_segments parts, a group of eight threads each, so that light_fill writes lists in light order.
struct LightAssign {
  static constexpr std::string_view name = "light_assign";
  using SharedKnobs = std::tuple<LightKnobs>;
  struct In {
    SceneInputs scene;
    LightBoxes boxes;
    BufferHandle tiles;  // of tile_depth; optional, empty for clusters
  };
  struct Out {
    BufferHandle lists;       // bitmasks, or how many lights each cell has: by segments, a row of cells for each
    BufferHandle sums, hits;  // compact: counts of groups of cells (not by segments), a bit a thread
    PipelineHandle pipeline;
  };
  bool ignores(std::string_view knob) const;
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  LightGridShape grid;
};

}  // namespace candela
