#pragma once
#include <array>

#include "passes/post/subframes_knobs.h"
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"

namespace candela {

// Motion blur, depth of field and edges, by the accumulation buffer (Haeberli and Akeley, "The Accumulation Buffer",
// 1990): a picture with a shutter or a lens is the mean of n frames, each at its own moment of the open shutter, from
// its own point of the lens and through its own place in the pixel (plan/subframes.h). This pass adds one of them, by
// its n-th part, to the sum of those before it, in linear radiance before bloom and tone curve. Sums are buffers of the
// picture's texels, which outlive the frame. Leaves wrong: what n samples miss of time, lens and pixel; the same points
// serve all pixels, so too few show as several images of what moves or is out of focus, not as noise.
struct Subframes {
  static constexpr std::string_view name = "subframes";
  static constexpr std::array<std::string_view, 2> shading_effects = {"shutter", "lens"};
  using Knobs = SubframesKnobs;
  struct In {
    ImageHandle color;    // optional: of this frame, at least as large as the picture; empty: it shows nothing of it
    BufferHandle before;  // the sum of the frames before it; of the first frame anything
    BufferHandle sum;
    glm::ivec2 first_px{0};  // of the frame: where the picture begins
    uint32_t width_px = 0, height_px = 0;
    Live<uint32_t> index = 0u;  // which of the picture's frames
    uint32_t count = 1;         // of so many
  };
  struct Out {
    BufferHandle sum;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

// The sum of all of them as the picture that follows.
struct SubframesMean {
  static constexpr std::string_view name = "subframes_mean";
  struct In {
    BufferHandle sum;
    uint32_t width_px = 0, height_px = 0;
  };
  struct Out {
    ImageHandle color;
    PipelineHandle pipeline;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
