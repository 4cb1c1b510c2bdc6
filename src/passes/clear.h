#pragma once
#include "passes/draw_runs.h"
#include "passes/pass.h"

namespace candela {

// The background alone, for a frame in which nothing else draws.
struct Clear {
  static constexpr std::string_view name = "clear";
  struct In {
    SceneInputs scene;
  };
  struct Out {
    ImageHandle color;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const {
    return needed_if(facts.draw_items == 0 && !(facts.environment && request.draw_background),
                     "the first drawing pass clears");
  }
  Out declare(GraphBuilder& builder, const In& in) const { return {write_color(builder, in.scene, {})}; }
  void record(CommandList& commands, const In&, const Out& out) const {
    const CommandList::Attachment color{out.color};
    commands.begin_rendering({&color, 1}, {});
    commands.end_rendering();
  }
};

}  // namespace candela
