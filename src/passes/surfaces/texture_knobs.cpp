#include "passes/surfaces/texture_knobs.h"

namespace candela {

std::span<const Knob<TextureKnobs>> TextureKnobs::knob_table() {
  // Every device that filters anisotropically at all does so up to 16 (Vulkan, required limits).
  static const Knob<TextureKnobs> table[] = {
      {"anisotropy",
       &TextureKnobs::anisotropy,
       "",
       1,
       16,
       {1, 4, 8, 16},
       "samples along the longer axis of a pixel's footprint in a texture; 1: one mip level for both axes, which blurs "
       "what is seen at a slant",
       {},
       Trades::error,
       {},
       {"depth_prepass", "shade_forward", "shade_unlit", "transparent", "layers"}},
  };
  return table;
}

}  // namespace candela
