#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"

namespace candela {

// How far the surface at the pixel's centre has moved in the picture since the frame before: its place in pixels less
// the place that the same point of the surface had then, x to the right, y up, from the camera, nodes, skins and morphs
// of both times. Of the nearest opaque or masked surface, one sample; blended surfaces do not appear. 0 where there is
// nothing, and where the point was behind the camera and had no place. Exact up to 32-bit arithmetic; what does not
// move has exactly 0, and where nothing does nothing is drawn.
struct MotionLayer {
  static constexpr std::string_view name = "motion";
  using SharedKnobs = std::tuple<TextureKnobs, ReliefKnobs>;  // of masks
  static constexpr LayerName layers[1] = {
      {"motion", "motion of the surface in the picture since the frame before, in pixels, y up", LayerForm::motion}};
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;         // optional
    BufferHandle deformed_before;  // optional
  };
  struct Out {
    ImageHandle motion;
    NearestSurface drawn;  // empty where nothing moves
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
