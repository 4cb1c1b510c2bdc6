#include "techniques/technique.h"

namespace candela {

ImageHandle composite(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                      ImageHandle shaded, std::string_view instance) {
  const auto& [draws, deformed, depth] = surfaces;
  ImageHandle color =
      newest(frame.add(Sky{}, {scene, depth, shaded, fog_to_infinity(lighting.lists)}, instance).color, shaded);
  color =
      newest(frame.add(Background{}, {scene, depth, color, fog_to_infinity(lighting.lists)}, instance).color, color);
  return newest(
      frame.add(Transparent{}, {scene, draws, deformed, of_blended(lighting.lists), depth, color}, instance).color,
      color);
}

}  // namespace candela
