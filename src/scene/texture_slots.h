#pragma once
#include "scene/material_table.h"

namespace candela {

// Calls f(slot, whether its colours are sRGB) for every texture that shading the material may read at some time of its
// animation.
template <class F>
void for_each_slot(const Material& m, F&& f) {
  for (const MaterialTexture& t : material_textures())
    if (t.slot == TextureSlotName::base_color || t.slot == TextureSlotName::relief || !m.unlit) f(t.of(m), t.srgb);
}

// The same of a posed material: textures of lobes that it does not show are not read.
template <class F>
void for_each_shown_slot(const Material& m, F&& f) {
  for (const MaterialTexture& t : material_textures())
    if (t.read(m)) f(t.of(m), t.srgb);
}

// Whether a slot of the material is a normal map.
inline bool is_normal_map(const Material& m, const TextureSlot& slot) {
  return &slot == &m.normal_texture || &slot == &m.clearcoat.normal_texture;
}

}  // namespace candela
