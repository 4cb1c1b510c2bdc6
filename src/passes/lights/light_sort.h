#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// Brings each cell's list into light order: sums are then the same bit for bit on every run and for every kind of list.
// With the knob lights.cap it also counts what the cap loses.
struct LightSort {
  static constexpr std::string_view name = "light_sort";
  using InputKnobs = std::tuple<LightKnobs>;
  struct In {
    BufferHandle offsets, unsorted;
  };
  struct Out {
    BufferHandle entries;
    BufferHandle report;  // empty without a cap
    PipelineHandle rank, sort;
  };
  // What the cap loses: it must not do so in silence.
  struct Report {
    uint32_t lost, cells, longest;  // entries lost, cells that lost some, entries of the longest list
  };
  std::vector<std::string> warnings(const Report& report) const;
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  LightGridShape grid;
};

}  // namespace candela
