#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"
#include "passes/shared/volume_lists.h"

namespace candela {

// `debug_light_volumes`: how many lights' volumes (passes/lights/light_volumes.h) cover a pixel's centre, whatever lies
// before or behind: what deferred-volumes asks a pixel for. The bodies are drawn on top of each other and counted;
// lights that reach everywhere cover every pixel. 0 where the scene has none.
struct LightVolumeLayer {
  static constexpr std::string_view name = "light_volume_layer";
  static constexpr LayerName layers[1] = {
      {"debug_light_volumes", "how many lights' volumes cover the pixel", LayerForm::count}};
  struct In {
    SceneInputs scene;
    LightVolumes volumes;  // optional: in one list; empty: no light
  };
  struct Out {
    ImageHandle count;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
