#pragma once
#include "passes/shared/pass.h"

namespace candela {

// Of the passes of occlusion culling (passes/geometry/occlusion_cull.h). Not a pass.
struct OcclusionCullKnobs {
  static constexpr std::string_view name = "occlusion_cull";
  enum Mode : int { off, on, automatic };
  int mode = automatic;
  float first_fraction = 0.005f;
  static std::span<const Knob> table();
};
Need needs_occlusion_culling(const SceneFacts& facts, const OcclusionCullKnobs& knobs);

}  // namespace candela
