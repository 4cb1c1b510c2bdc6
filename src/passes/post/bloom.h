#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"
#include "shared/bloom.h"

namespace candela {

// Light that lens and eye scatter: the picture (what of it is above a threshold, with a soft knee) through a sum of
// Gaussians of the variances 1.5 (4^k - 1) square pixels, k = 1, 2, ..., each by the look's weight (look/look.h,
// Bloom). Those are the variances of the levels of a pyramid of 13 taps down and a 3x3 tent up (Jimenez, "Next
// Generation Post Processing in Call of Duty: Advanced Warfare", 2014), which stands for them; levels=0 convolves with
// the Gaussians. Linear radiance in and out, before tone mapping. It keeps energy where the look does (what glows is
// taken from where it came), up to what the picture's edge holds back, and reports both sums. Leaves wrong: a level's
// kernel is no Gaussian but a piecewise cubic, and not the same at every pixel; levels beyond `levels` are drawn as
// wide as the last; with `karis` bright single pixels glow less than they should.
struct BloomPass {
  static constexpr std::string_view name = "bloom";
  static constexpr std::string_view effect = "bloom";
  static constexpr LayerName layers[] = {{"bloom", "what bloom adds to the picture"}};
  struct Knobs {
    static constexpr std::string_view name = "bloom";
    int levels = 8;
    int karis = 0;
    static std::span<const Knob> table();
  };
  struct In {
    ImageHandle color;  // resolved
    uint32_t width_px = 0, height_px = 0;
    Live<Bloom> look;
    Live<float> exposure = 1;  // from the picture's units to those of the look's threshold
    bool glow_wanted = false;
    ImageHandle source = {};  // what glows, resolved, where the look says that emission alone does
  };
  struct Out {
    ImageHandle color;
    BufferHandle report;
    ImageHandle down, up, glow;  // down: levels from half size, or rows; up: the sum on its way
    ImageHandle blurred;         // the convolutions' sum
    BufferHandle energies;
    std::vector<PipelineHandle> pipelines;
  };
  using Report = shared::BloomReport;
  std::vector<std::string> warnings(const Report& report) const;
  std::vector<std::string> notes(const Report& report) const;
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
