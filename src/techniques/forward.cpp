#include "passes/shared/light_lists.h"
#include "passes/shared/scene_inputs.h"
#include "passes/surfaces/put_samples.h"
#include "passes/surfaces/shade_visible.h"
#include "passes/surfaces/surface_pass.h"
#include "techniques/technique.h"

namespace candela {

// Forward shading after a depth pre-pass. The techniques that it serves differ in nothing but the light grid of the
// scene's inputs: clusters (Olsson, Billeter, Assarsson, "Clustered Deferred and Forward Shading", 2012), where a point
// takes the list of its own depth; tiles between the depths of their samples (Harada, McKee, Yang, "Forward+: Bringing
// Deferred Lighting to the Next Level", 2012), where a point outside them takes the list of its column; or none, where
// every pixel walks every light.
Shaded forward(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
               std::string_view instance) {
  if (is_first_picture(instance))
    for (const std::string_view pass : {ShadeVisible::name, PutSamples::name})
      frame.builder.leave_out(std::string(pass), "surfaces are shaded as the hardware draws them");
  return {draw_forward(frame, scene, surfaces, lighting, {}, false, instance)};
}

ImageHandle draw_forward(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                         ImageHandle color, bool lines_alone, std::string_view instance) {
  SurfacePass<true>::In lit{scene, surfaces.visible, surfaces.deformed, lighting, surfaces.depth, color};
  lit.lines_alone = lines_alone;
  color = newest(frame.add(ShadeForward{}, lit, instance).color, color);
  SurfacePass<false>::In unlit{
      scene, surfaces.visible, surfaces.deformed, fog_alone(lighting.unoccluded()), surfaces.depth, color};
  unlit.lines_alone = lines_alone;
  return newest(frame.add(ShadeUnlit{}, unlit, instance).color, color);
}

}  // namespace candela
