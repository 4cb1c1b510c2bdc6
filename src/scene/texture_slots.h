#pragma once
#include "scene/scene.h"

namespace candela {

// Calls f(slot, whether its colours are sRGB) for every texture that shading the material may read.
template <class F>
void for_each_slot(const Material& m, F&& f) {
  f(m.base_color_texture, true);
  if (m.unlit) return;
  f(m.orm_texture, false);
  f(m.occlusion_texture, false);
  f(m.normal_texture, false);
  f(m.emissive_texture, true);
  f(m.specular_texture, false);
  f(m.specular_color_texture, true);
}

// The same for slots that only path tracing reads.
template <class F>
void for_each_traced_slot(const Material& m, F&& f) {
  if (!m.unlit && m.transmission > 0) f(m.transmission_texture, false);
}

}  // namespace candela
