#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

struct RasterKnobs {
  static constexpr std::string_view name = "rasterize";
  int small_px = 32, list = 524288;
  static std::span<const Knob> table();
};
// What both passes below do by.
struct RasterSteps {
  BufferHandle large, groups;
  PipelineHandle batches, count, tiles;
};
// A visibility buffer (Burns, Hunt, "The Visibility Buffer: A Cache-Friendly Approach to Deferred Shading", 2013), made
// in compute: for each sample of each pixel 64 bits, those of the depth of the nearest opaque or masked triangle over
// 1 + its number in the order of drawing, or 0. The largest wins by an atomic maximum (Karis, Stubbe, Wihlidal, "A Deep
// Dive into Nanite Virtualized Geometry", 2021): of equal depths what is drawn last, as in hardware, however threads
// arrive. Triangles over few pixels are one thread's; others are listed, and their tiles dealt out to workgroups.
// Coverage is the hardware's: corners snapped to 1/256 pixel, standard sample places. Lines and points are not in it.
// Leaves wrong: depths may differ from the hardware's in their last bits. Needs shaderBufferInt64Atomics.
struct Rasterize {
  static constexpr std::string_view name = "rasterize";
  using Knobs = RasterKnobs;
  using SharedKnobs = std::tuple<TextureKnobs, ReliefKnobs>;  // of masks, and of reliefs
  using InputKnobs = std::tuple<CullKnobs, OcclusionCullKnobs, MaskKnobs, ResolveKnobs, SupersampleKnobs>;
  struct In {
    SceneInputs scene;
    BufferHandle masks;     // of culling, by the camera
    BufferHandle deformed;  // optional
    bool masks_by_sample = false;
    BufferHandle keys;  // optional: of what is rasterized already
  };
  struct Out {
    BufferHandle keys;
    RasterSteps steps;
    PixelRect part;  // pixels that are wanted
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

// The same for a range of views that see depth alone, in the place of DepthViews: in one buffer for all, with 32 bits a
// texel, which then becomes the layered image.
struct RasterizeViews {
  static constexpr std::string_view name = "rasterize_views", effect = "shadows";
  using Knobs = RasterKnobs;
  using SharedKnobs = std::tuple<SunKnobs, LampKnobs, ReliefKnobs>;
  using InputKnobs = std::tuple<CullKnobs, LightRangeKnobs, ColoredShadowKnobs, DeepShadowKnobs>;
  struct In {
    SceneInputs scene;
    ViewRange views;
    BufferHandle masks;     // of culling, by these views
    BufferHandle deformed;  // optional
    std::shared_ptr<const ViewImage> image;
    // The image holds plain floats instead of depths: written in compute, where a GPU's copy of a buffer to an image
    // takes several times as long.
    bool floats = false;
  };
  struct Out {
    ImageHandle depth;
    BufferHandle texels;
    RasterSteps steps;
    PipelineHandle store;       // of floats
    PipelineHandle store_over;  // of views that are drawn over others
    PipelineHandle clear;       // of views that are drawn apart
    ImageHandle cleared;        // of views that are drawn apart: what is between their tiles
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
