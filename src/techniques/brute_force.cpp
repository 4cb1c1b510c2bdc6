#include "techniques/forward.h"

namespace candela {

// The shading of the other techniques with no lists: every pixel walks every light.
FrameImages brute_force(Frame& frame, const SceneInputs& scene, const FrameKnobs& knobs) {
  return forward_shading(frame, scene, forward_geometry(frame, scene, knobs), {});
}

}  // namespace candela
