#include "passes/lights/light_volumes.h"
#include "passes/shared/light_lists.h"
#include "passes/shared/scene_inputs.h"
#include "passes/shared/volume_lists.h"
#include "passes/surfaces/gbuffer.h"
#include "passes/surfaces/gbuffer_images.h"
#include "passes/surfaces/shade_gbuffer.h"
#include "passes/surfaces/shade_volumes.h"
#include "techniques/technique.h"

namespace candela {
namespace {
GBufferImages gbuffer_of(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lists,
                         std::string_view instance) {
  return frame.add(GBuffer{}, {scene, surfaces.visible, surfaces.deformed, lists, surfaces.depth}, instance).gbuffer;
}
}  // namespace

// Deferred shading: what surfaces are, and then their light, in compute, by the lists of lights that the forward
// techniques walk (Lauritzen, "Deferred Rendering for Current and Future Rendering Pipelines", 2010; clusters: Olsson,
// Billeter, Assarsson 2012).
Shaded deferred(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                std::string_view instance) {
  const Lighting lists = lighting;
  const GBufferImages gbuffer = gbuffer_of(frame, scene, surfaces, lists, instance);
  return {sampled_image(
      frame, scene, frame.add(ShadeGBuffer{}, {scene, gbuffer, lists, surfaces.deformed}, instance).samples, instance)};
}

// The same, light by light (Hargreaves and Harris, "Deferred Shading", 2004).
Shaded deferred_volumes(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                        std::string_view instance) {
  const Lighting lists = lighting;
  const GBufferImages gbuffer = gbuffer_of(frame, scene, surfaces, lists, instance);
  const LightVolumes volumes =
      frame.add(LightVolumeLists{}, {scene, frame.knobs.get<ShadeVolumes::Knobs>().depth_test == 0}, instance).volumes;
  return {
      frame.add(ShadeVolumes{}, {scene, gbuffer, lists, volumes, surfaces.depth, surfaces.deformed}, instance).color};
}

}  // namespace candela
