#include "techniques/forward.h"

namespace candela {

// Clustered forward shading (Olsson, Billeter, Assarsson, "Clustered Deferred and Forward Shading", 2012): tiles cut into
// exponential depth slices. A point takes the list of its own depth, so blended surfaces and multisampled edges are right.
FrameImages clustered(Frame& frame, const SceneInputs& scene, const FrameKnobs& knobs) {
  const ForwardGeometry geometry = forward_geometry(frame, scene, knobs);
  return forward_shading(frame, scene, geometry, make_light_lists(frame, scene, {}));
}

}  // namespace candela
