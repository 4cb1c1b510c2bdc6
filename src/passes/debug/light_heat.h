#pragma once
#include "passes/shared/draw_batches.h"
#include "passes/shared/pass.h"

namespace candela {

// How light lists fare at each pixel, as counts: lights listed; of them, those that give exactly nothing there (out of
// range or cone); and lights that give something and are not listed, which is 0 or a defect. Of the nearest opaque or
// masked surface, at the pixel's centre. Walks every light for every pixel: for looking, not for frames that are timed.
struct LightHeat {
  static constexpr std::string_view name = "light_heat";
  static constexpr LayerName layers[3] = {
      {"heatmap_lights", "how many lights the list of the point holds", LayerForm::count},
      {"heatmap_waste", "of them, those that give nothing there", LayerForm::count},
      {"heatmap_missed", "lights that give something there and are not listed", LayerForm::count}};
  struct In {
    SceneInputs scene;
    Draws draws;
    BufferHandle deformed;  // optional
    Lighting lists;         // empty: every light for every pixel
  };
  struct Out {
    std::array<ImageHandle, 3> counts;
    NearestSurface drawn;
  };
  Need needed(const SceneFacts& facts, const FrameRequest& request) const;
  Out declare(GraphBuilder& builder, const In& in) const;
  void record(CommandList& commands, const In& in, const Out& out) const;
};

}  // namespace candela
