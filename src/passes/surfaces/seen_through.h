#pragma once
#include "passes/geometry/draw_runs.h"

namespace candela {

// What surfaces that let light through look up (shaders/lib/refraction.glsl). Not a pass: Refraction makes it, and what
// shades them again takes it too.
struct SeenThrough {
  ImageHandle picture;  // of one sample, without them
  ImageHandle pyramid;  // the same in the next lower powers of two, and its mips
  ImageHandle behind;   // depth of what is opaque, at the frame's samples; empty: nothing is
  uint32_t lobe_samples = 0;
  explicit operator bool() const { return bool(pyramid); }
};

// Declares what is read, and completes the shaders and constants of a choice that has lights and fog.
void declare_seen_through(GraphBuilder& builder, const SceneInputs& scene, const SeenThrough& seen,
                          RunPipelineChoice& choice);
OwnInputs own_inputs(CommandList& commands, const SeenThrough& seen);

}  // namespace candela
