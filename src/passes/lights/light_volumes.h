#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"
#include "passes/shared/volume_lists.h"

namespace candela {

// Which lights are drawn as volumes, and how (shared/light_volumes.h): those that reach everywhere over the whole
// picture, others by a body about what they reach, whose front faces are drawn where the camera is outside of it, by
// the body's widest radius and the corner of the near plane, and else its back faces; none that the camera's frustum
// does not meet. Each list keeps the order of the lights. Of a light without an end, or farther than floats can say:
// the whole picture.
struct LightVolumeLists {
  static constexpr std::string_view name = "light_volume_lists";
  using InputKnobs = std::tuple<LightVolumeKnobs>;
  struct In {
    SceneInputs scene;
    bool ordered = false;  // one list, of all kinds
  };
  struct Out {
    LightVolumes volumes;
    BufferHandle masks, counts;
    PipelineHandle cull, list;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
