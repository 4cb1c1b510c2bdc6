#pragma once
#include "passes/geometry/draw_runs.h"
#include "passes/pass.h"

namespace candela {

// Radiance of lit opaque and masked surfaces: glTF 2.0 metallic-roughness under every punctual light that reaches them
// (each pixel walks its cell's list, or all lights, in light order), plus ambient light and emission. Only fragments
// that won the depth pre-pass are shaded (EQUAL test). Units: cd/m2 times the pre-exposure. Leaves wrong: no shadows,
// ambient reflections as blurred as diffuse light.
struct ShadeForward {
  static constexpr std::string_view name = "shade_forward";
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;  // optional
    CellLists lists;        // empty: every light for every pixel
    ImageHandle depth;      // of the pre-pass
    ImageHandle color;      // optional: without one the pass makes and clears it
  };
  struct Out {
    ImageHandle color;
    RunPipelines pipelines;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
