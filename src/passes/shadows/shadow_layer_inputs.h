#pragma once
#include "passes/shared/draw_batches.h"

namespace candela {

// What layers of shadows are drawn from, those of suns and those of local lights.
struct ShadowLayerInputs {
  SceneInputs scene;
  Draws draws;
  BufferHandle deformed;  // optional
  Lighting lists;         // for the maps
};

}  // namespace candela
