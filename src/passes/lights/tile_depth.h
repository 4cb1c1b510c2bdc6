#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// Nearest and farthest depth of every 16x16 tile over all MSAA samples, and a mask of the 32 slices between them that
// hold a surface (Harada, "A 2.5D Culling for Forward+", 2012). Metres. Sky does not count.
struct TileDepth {
  static constexpr std::string_view name = "tile_depth";
  static constexpr uint32_t tile_px = 16;
  struct In {
    SceneInputs scene;
    ImageHandle depth;  // of the pre-pass
  };
  struct Out {
    BufferHandle tiles;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  LightGridShape grid;
};

}  // namespace candela
