#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// Writes every light that light_assign found into its cells' lists. The order inside a list is that of the threads'
// arrival; light_sort mends it. By segments it is the lights'.
struct LightFill {
  static constexpr std::string_view name = "light_fill";
  struct In {
    SceneInputs scene;
    LightBoxes boxes;
    BufferHandle offsets, hits;
    BufferHandle rows;  // by segments (LightScan), which this pass uses up; else empty
  };
  struct Out {
    BufferHandle entries, cursors;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  LightGridShape grid;
};

}  // namespace candela
