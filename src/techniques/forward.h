#pragma once
#include "techniques/technique.h"

namespace candela {

// What the forward techniques share: they differ in nothing but the light lists.
struct ForwardGeometry {
  Draws draws;
  BufferHandle deformed;
  ImageHandle depth;
};
ForwardGeometry forward_geometry(Frame& frame, const SceneInputs& scene, const FrameKnobs& knobs);
// tiles: depths of the grid's tiles, for a tiled grid.
CellLists make_light_lists(Frame& frame, const SceneInputs& scene, BufferHandle tiles);
FrameImages forward_shading(Frame& frame, const SceneInputs& scene, const ForwardGeometry& geometry,
                            const CellLists& lists);

}  // namespace candela
