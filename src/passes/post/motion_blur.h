#pragma once
#include <array>

#include "passes/post/subframes_knobs.h"
#include "passes/shared/pass.h"
#include "passes/shared/sampled_depth.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// The cheap level of an open shutter: one frame, whose pixels gather along the motion of what is near them (McGuire,
// Hennessy, Bukowski and Osman, "A Reconstruction Filter for Plausible Motion Blur", 2012). Three steps: the longest
// motion of each tile, the longest of a tile and its neighbours, and the gather. Linear radiance in and out. Leaves
// wrong: behind a moving edge it has to invent what the frame does not show; motion is straight and even within the
// shutter; longer motion than most_px is shortened; shadows, reflections and lights stay sharp; background and blended
// surfaces have the motion of the surface behind or before them, or none. Subframes are the exact end
// (subframes.gather=0).
struct MotionBlur {
  static constexpr std::string_view name = "motion_blur";
  struct Knobs {
    static constexpr std::string_view name = "motion_blur";
    int samples = 16;
    int most_px = 32;
    static std::span<const Knob> table();
  };
  using SharedKnobs = std::tuple<SubframesKnobs>;
  struct In {
    SceneInputs scene;
    ImageHandle color;   // resolved
    ImageHandle motion;  // of MotionLayer; empty: nothing moves
    SampledDepth depth;
    float share = 0;  // of the motion since the frame before, which the shutter is open for
    uint32_t seed = 0;
  };
  struct Out {
    ImageHandle tiles, neighbours, color;
    std::array<PipelineHandle, 3> pipelines;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
