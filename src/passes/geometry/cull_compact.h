#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// Second half of culling: prefix sums over the survivors' counts and bits give every item that stays its place, so the
// indirect commands of all views and runs of the range lie in one buffer, each region without gaps and in item order,
// whatever the device's scheduling.
struct CullCompact {
  static constexpr std::string_view name = "cull_compact";
  using InputKnobs = std::tuple<CullKnobs, OcclusionCullKnobs, ColoredShadowKnobs, DeepShadowKnobs>;
  struct In {
    SceneInputs scene;
    BufferHandle masks, survivors;
    ViewRange views{};
  };
  struct Out {
    Draws draws;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
