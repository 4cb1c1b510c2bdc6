#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"
#include "passes/shared/sampled_depth.h"

namespace candela {

// Light of point and spot lights that the air turns once towards the camera, as a look effect of its own over the
// resolved picture (Toth and Umenhoffer, "Real-time Volumetric Lighting in Participating Media", 2009): each coarse
// texel's ray is followed in even steps that begin off each other by a Bayer matrix, with the lamps' shadow maps on the
// way; then filtered and enlarged. What is summed is look/look.h's Volumetric. The inverse square of a step is its
// mean over it, in closed form, and so is what the air leaves on the way to the camera; the rest is taken at the step's
// point. Units: radiance as in beauty, pre-exposed.
//
// Leaves wrong: shadows, cones and phase are points of a step; a texel follows one of its pixels; the filter blurs;
// separated into rows and columns, a bilateral filter streaks at corners; lamps without maps shine through everything;
// blended surfaces stand before it, where they should be within.
struct VolumetricLight {
  static constexpr std::string_view name = "volumetric";
  static constexpr std::string_view effect = "volumetric";
  static constexpr LayerName layers[] = {{"volumetric", "light of local lights in the air over the picture"}};
  enum class Filter : int { none, gauss, bilateral };
  struct Knobs {
    static constexpr std::string_view name = "volumetric";
    int texel_px = 2;
    int samples = 50;
    int bayer = 4;
    int filter = int(Filter::none);
    int depth = 1;     // coarse_nearest, coarse_checkerboard
    int upsample = 1;  // bilinear, depth
    static std::span<const Knob> table();
  };
  using SharedKnobs = std::tuple<LightRangeKnobs>;
  struct In {
    SceneInputs scene;
    ImageHandle color;   // resolved
    SampledDepth depth;  // optional: nothing is drawn
    Lighting lists;
    Live<Volumetric> look;
    bool layer_wanted = false;
  };
  struct Out {
    ImageHandle color, layer;
    std::array<ImageHandle, 2> coarse;
    std::vector<PipelineHandle> pipelines;  // by step
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
