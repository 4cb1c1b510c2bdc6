#include "passes/surfaces/texture_knobs.h"

namespace candela {

std::span<const Knob> TextureKnobs::table() {
  // Every device that filters anisotropically at all does so up to 16 (Vulkan, required limits).
  static const Knob table[] = {
      {.name = "anisotropy",
       .member = &TextureKnobs::anisotropy,
       .lowest = 1,
       .highest = 16,
       .levels = {1, 4, 8, 16},
       .description =
           "samples along the longer axis of a pixel's footprint in a texture; 1: one mip level for both axes, "
           "which blurs what is seen at a slant"},
  };
  return table;
}

bool TextureKnobs::matter(const SceneFacts& f) {
  return f.any_base_texture || f.any_orm_texture || f.any_occlusion_texture || f.any_normal_texture ||
         f.any_emissive_texture || f.any_specular_texture || f.lobe_textures != 0;
}

}  // namespace candela
