#include "techniques/technique.h"

namespace candela {

Surfaces visible_surfaces(Frame& frame, const SceneInputs& scene) {
  const Cull::Out culled = frame.add(Cull{}, {scene});
  Surfaces surfaces;
  surfaces.draws = frame.add(CullCompact{}, {scene, culled.masks, culled.survivors}).draws;
  surfaces.deformed = frame.add(Deform{}, {scene}).deformed;
  surfaces.depth = frame.add(DepthPrepass{}, {scene, surfaces.draws, surfaces.deformed}).depth;
  return surfaces;
}

Surfaces seen_again(Frame& frame, const SceneInputs& scene, Surfaces surfaces, std::string_view instance) {
  surfaces.depth = frame.add(DepthPrepass{}, {scene, surfaces.draws, surfaces.deformed}, instance).depth;
  return surfaces;
}

namespace {
// Deformed vertices of the time before; this one's where they are the same.
BufferHandle deformed_before(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces) {
  if (!scene.joints_before && !scene.weights_before) return surfaces.deformed;
  SceneInputs before = scene;
  before.joints = scene.joints_before, before.weights = scene.weights_before;
  return frame.add(Deform{}, {before}, "before").deformed;
}
}  // namespace

void describe(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
              const OcclusionTexels& occlusion) {
  Layers::In wanted{scene, surfaces.draws, surfaces.deformed, lighting.lists};
  for (uint32_t i = 0; i < layer_count; ++i) wanted.wanted[i] = frame.request.has_layer(Layers::layers[i].name);
  frame.add(Layers{}, wanted);
  frame.add(SunLayers{}, {scene, surfaces.draws, surfaces.deformed, lighting.lists});
  frame.add(LampLayers{}, {scene, surfaces.draws, surfaces.deformed, lighting.lists});
  frame.add(OcclusionLayer{}, {scene, surfaces.draws, surfaces.deformed, occlusion, lighting.lists.rays});
  frame.add(MotionLayer{}, {scene, surfaces.draws, surfaces.deformed, deformed_before(frame, scene, surfaces)});
  frame.add(LightHeat{}, {scene, surfaces.draws, surfaces.deformed, lighting.lists});
}

}  // namespace candela
