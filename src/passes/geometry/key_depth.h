#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// Tiles of the picture, 16 pixels a side, that the boxes of blended items in view may touch: where their depth is
// tested. A word for each tile, row by row; 0: none touches it.
struct BlendedTiles {
  static constexpr std::string_view name = "blended_tiles";
  using InputKnobs = std::tuple<CullKnobs>;
  struct In {
    SceneInputs scene;
    BufferHandle kept_items;  // a bit for each item in view
  };
  struct Out {
    BufferHandle tiles;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts&, const FrameRequest&) const {
    return needed_if(wanted, "depths are needed in all of the picture, or in none of it");
  }
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  bool wanted = true;
};

// The depths of keys as an image, for passes that test against it or sample it. With tiles: in these alone, 0
// elsewhere.
struct KeyDepth {
  static constexpr std::string_view name = "key_depth";
  struct Knobs {
    static constexpr std::string_view name = "key_depth";
    int tiles = 1;
    static std::span<const Knob> table();
  };
  Knobs knobs;
  using InputKnobs = SampleCountKnobs;
  struct In {
    BufferHandle keys;
    BufferHandle tiles;  // optional
    uint32_t width_px = 0, height_px = 0, samples = 1;
  };
  struct Out {
    ImageHandle depth;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts&, const FrameRequest&) const { return {}; }
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
