#include "passes/debug/mattes.h"
#include "passes/shared/scene_inputs.h"
#include "techniques/technique.h"

namespace candela {

void matte_ids(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, MatteImages& images,
               std::string_view instance) {
  for (uint32_t i = 0; i < matte_count; ++i) {
    MatteIds pass;
    pass.matte = Matte(i);
    // A layer that is not asked for is reported once, not for each picture.
    if (!pass.needed(frame.facts, frame.request) && !instance.empty()) continue;
    const std::string_view layer = matte_layers[i].name;
    const std::string name = instance.empty() ? std::string(layer) : fmt::format("{}.{}", instance, layer);
    const bool wanted = bool(pass.needed(frame.facts, frame.request));
    const ImageHandle depth = wanted ? depth_of_hardware(frame, scene, surfaces, name) : surfaces.depth;
    images[i] = frame.add(pass, {scene, surfaces.visible, surfaces.deformed, depth, images[i]}, name).ids;
  }
}

void publish_mattes(Frame& frame, const SceneInputs& scene, const MatteImages& images, uint32_t pictures) {
  for (uint32_t i = 0; i < matte_count; ++i) {
    MatteRanks pass;
    pass.matte = Matte(i);
    MatteRanks::In in{images[i], scene.width_px, scene.height_px, scene.samples * pictures, scene.samples > 1};
    frame.add(pass, in, matte_layers[i].name);
  }
}

}  // namespace candela
