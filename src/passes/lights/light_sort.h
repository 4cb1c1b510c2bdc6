#pragma once
#include "passes/pass.h"
#include "passes/scene_inputs.h"

namespace candela {

// Brings each cell's list into light order: sums are then the same bit for bit on every run and for every kind of list.
// With the knob lights.cap it also counts what the cap loses.
struct LightSort {
  static constexpr std::string_view name = "light_sort";
  struct In {
    BufferHandle offsets, unsorted;
  };
  struct Out {
    BufferHandle entries;
    BufferHandle lost;  // host: entries lost to the cap, cells that lost some, longest list; empty without a cap
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  LightGridShape grid;
};

}  // namespace candela
