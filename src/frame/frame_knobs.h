#pragma once
#include "base/error.h"
#include "frame/job.h"
#include "passes/lights/light_knobs.h"
#include "passes/surfaces/texture_knobs.h"

namespace candela {

// The values that a job's quality and settings give to the knobs of all passes.
struct FrameKnobValues {
  int samples = 4;
  bool cull_enabled = true;
  LightKnobs lights;
  TextureKnobs textures;
};
// Errors (usage): an unknown pass or knob, a value that is not a number or out of range: names what there is.
Expected<FrameKnobValues> frame_knobs(const Job& job);

}  // namespace candela
