#include "techniques/technique.h"

namespace candela {

ImageHandle composite(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                      ImageHandle shaded) {
  const auto& [draws, deformed, depth] = surfaces;
  ImageHandle color = newest(frame.add(Sky{}, {scene, depth, shaded}).color, shaded);
  color = newest(frame.add(Background{}, {scene, depth, color}).color, color);
  return newest(frame.add(Transparent{}, {scene, draws, deformed, lighting.lists, depth, color}).color, color);
}

}  // namespace candela
