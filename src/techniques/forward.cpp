#include "techniques/technique.h"

namespace candela {

// Forward shading after a depth pre-pass. The techniques that it serves differ in nothing but the light grid of the
// scene's inputs: clusters (Olsson, Billeter, Assarsson, "Clustered Deferred and Forward Shading", 2012), where a point
// takes the list of its own depth; tiles between the depths of their samples (Harada, McKee, Yang, "Forward+: Bringing
// Deferred Lighting to the Next Level", 2012), where a point outside them takes the list of its column; or none, where
// every pixel walks every light.
ImageHandle forward(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                    std::string_view instance) {
  const auto& [draws, deformed, depth] = surfaces;
  const ImageHandle color =
      frame.add(ShadeForward{}, {scene, draws, deformed, lighting.of_opaque(), depth, {}}, instance).color;
  return newest(
      frame.add(ShadeUnlit{}, {scene, draws, deformed, fog_alone(lighting.lists), depth, color}, instance).color,
      color);
}

}  // namespace candela
