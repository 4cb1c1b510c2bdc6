#include "passes/tile_depth.h"
#include "techniques/forward.h"

namespace candela {

// Tiled Forward+ (Harada, McKee, Yang, "Forward+: Bringing Deferred Lighting to the Next Level", 2012): tiles bounded by the depths
// of all their samples. Points outside a tile's depths (blended, or shaded off their sample) take the list of their column.
FrameImages forward_plus(Frame& frame, const SceneInputs& scene, const FrameKnobs& knobs) {
  const ForwardGeometry geometry = forward_geometry(frame, scene, knobs);
  const BufferHandle tiles = frame.add(TileDepth{scene.light_grid}, {scene, geometry.depth}).tiles;
  return forward_shading(frame, scene, geometry, make_light_lists(frame, scene, tiles));
}

}  // namespace candela
