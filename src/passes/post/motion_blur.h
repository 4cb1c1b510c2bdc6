#pragma once
#include <array>

#include "passes/post/subframes_knobs.h"
#include "passes/shared/pass.h"
#include "passes/shared/sampled_depth.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// The cheap level of an open shutter: one frame, whose pixels gather along the longest motion near them, which is found
// by tiles (McGuire, Hennessy, Bukowski and Osman, "A Reconstruction Filter for Plausible Motion Blur", 2012). What is
// met on the way is spread evenly over its own motion, in layers: what passes before the pixel's surface, that surface,
// and what is behind it (Jimenez, "Next Generation Post Processing in Call of Duty: Advanced Warfare", 2014); even
// straight motion before what stands comes out right. Linear radiance in and out. Leaves wrong: what the frame hides
// behind moving surfaces is made up of what is beside them; motion that turns or changes within the shutter, or is
// longer than most_px; shadows, reflections and lights stay sharp; background and blended surfaces have the motion of
// the surface behind or before them, or none. Subframes are the exact end (subframes.gather=0).
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
    Live<float> share = 0;  // of the motion since the frame before, which the shutter is open for
    Live<uint32_t> seed = 0u;
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
