#pragma once
#include "passes/geometry/draw_runs.h"
#include "passes/pass.h"

namespace candela {

// Surfaces that take no light: KHR_materials_unlit, and lines and points without normals. Base colour goes out as
// radiance.
struct ShadeUnlit {
  static constexpr std::string_view name = "shade_unlit";
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;  // optional
    ImageHandle depth;      // of the pre-pass
    ImageHandle color;      // optional: without one the pass makes and clears it
  };
  struct Out {
    ImageHandle color;
    RunPipelines pipelines;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
