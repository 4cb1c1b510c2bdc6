#pragma once
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"
#include "shared/exposure.h"

namespace candela {

// Automatic exposure: the mean log2 of the picture's luminance between two percentiles of its histogram comes out at
// the look's target (look/look.h, AutoExposure). Of this frame alone, without any before it, so that frames are the
// same in any order; counted in whole numbers, so that they are the same bytes. Linear radiance in, a factor out, which
// tone mapping applies. Leaves wrong: luminances are taken from the middles of the bins; what is darker than 2^-24 or
// brighter than 2^24 counts as that.
struct Exposure {
  static constexpr std::string_view name = "exposure";
  static constexpr std::string_view effect = "exposure";
  struct Knobs {
    static constexpr std::string_view name = "exposure";
    int bins = 256;
    static std::span<const Knob> table();
  };
  struct In {
    ImageHandle color;  // resolved
    uint32_t width_px = 0, height_px = 0;
    Live<AutoExposure> look;
    Live<float> scale = 1;  // from the picture's units to radiance
  };
  struct Out {
    BufferHandle exposure, report;  // an ExposureResult each
    BufferHandle counts;
    std::vector<PipelineHandle> pipelines;
  };
  using Report = shared::ExposureResult;
  std::vector<std::string> warnings(const Report& report) const;
  std::vector<std::string> notes(const Report& report) const;
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
  Knobs knobs;
};

}  // namespace candela
