#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"
#include "passes/shared/sampled_depth.h"
#include "passes/volumes/fog_knobs.h"

namespace candela {

// Light that fog scatters once towards the camera, followed along rays of coarse texels through the lists of lights: at
// most 64 steps, each as long as takes a fortieth of the light from the camera on, -ln(1 - 0.025/T)/extinction with T
// what is left there, 0.2 to 100 times the grid's first depth (fog.march_*), light taken at a point of each, other for
// each texel and from seed to seed. Surfaces take the texels about them by depth (shaders/lib/coarse_light.glsl).
// Units: radiance as in beauty, pre-exposed; the texel's depth beside it.
//
// In each step transmittance is integrated, not multiplied before the light is added; lengths are of the ray, not of
// depth; and the inverse square of lamps is a mean over the step. Leaves wrong: noise of the points, and texels that
// follow one of their pixels.
struct FogMarch {
  static constexpr std::string_view name = "fog_march";
  static constexpr std::string_view effect = "fog";
  using SharedKnobs = std::tuple<LightRangeKnobs, FogKnobs>;
  struct In {
    SceneInputs scene;
    Lighting lists;
    SampledDepth depth;  // optional: nothing is drawn
    bool ambient = false;
    int media = 0;  // FogView::media
    uint32_t seed = 0;
  };
  struct Out {
    ImageHandle light;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  FogKnobs shared_knobs;
};

}  // namespace candela
