#pragma once
#include "passes/pass.h"
#include "passes/scene_inputs.h"

namespace candela {

// Where each cell's list begins among all entries: an exclusive prefix sum of the counts that light_assign left.
struct LightScan {
  static constexpr std::string_view name = "light_scan";
  struct In {
    BufferHandle counts, sums;
  };
  struct Out {
    BufferHandle offsets;  // one more than there are cells: the last is the number of entries
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  LightGridShape grid;
};

}  // namespace candela
