#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// Morph targets and linear blend skinning on the GPU, once a frame, into a vertex buffer that all later passes read.
// Skinned vertices come out in relative space from joint matrices composed in double. Exact up to 32-bit float
// arithmetic.
struct Deform {
  static constexpr std::string_view name = "deform";
  struct In {
    SceneInputs scene;
    BufferHandle polygons{};  // of metaballs, beside which vertices go; may be empty
  };
  struct Out {
    BufferHandle deformed;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
