#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// Where each cell's list begins among all entries: an exclusive prefix sum of the counts that light_assign left. By
// segments a step before it sums the rows of each cell.
struct LightScan {
  static constexpr std::string_view name = "light_scan";
  using InputKnobs = std::tuple<LightKnobs>;
  struct In {
    BufferHandle counts;
    BufferHandle sums;  // optional: by segments there are none yet
  };
  struct Out {
    BufferHandle offsets;       // one more than there are cells: the last is the number of entries
    BufferHandle rows;          // by segments: how many entries of its list the segments before have
    BufferHandle totals, sums;  // by segments: of each cell, and of groups of cells
    PipelineHandle merge, pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  LightGridShape grid;
};

}  // namespace candela
