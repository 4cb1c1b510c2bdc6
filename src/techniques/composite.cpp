#include "passes/geometry/depth_prepass.h"
#include "passes/post/resolve.h"
#include "passes/reflections/reflections.h"
#include "passes/shared/frame_request.h"
#include "passes/shared/light_lists.h"
#include "passes/shared/pass.h"
#include "passes/shared/reflected.h"
#include "passes/shared/scene_inputs.h"
#include "passes/sky/background.h"
#include "passes/sky/sky.h"
#include "passes/surfaces/refraction.h"
#include "passes/surfaces/transparent.h"
#include "techniques/technique.h"

namespace candela {
namespace {

// Of surfaces that rays meet. Maps and texels know those before the camera alone, so shadows and occlusion are by rays.
Lighting lights_off_camera(const Lighting& lighting) {
  Lighting lists = fog_on_the_way(lighting.unoccluded());
  lists.rays.surfaces = true;
  lists.rays.suns |= bool(lists.sun_maps), lists.rays.lamps |= bool(lists.lamp_maps);
  lists.sun_maps = lists.lamp_maps = {};
  lists.deep = {};
  lists.occlusion = lighting.occlusion;
  lists.occlusion.traced |= bool(lists.occlusion.open);
  lists.occlusion.open = {};
  return lists;
}

Reflected reflections(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                      ImageHandle color, std::string_view instance) {
  const FrameRequest& request = frame.request;
  if (const Need need = Reflections{}.needed(frame.facts, request); !need)
    return frame.add(Reflections{}, {}, instance).reflected;
  const std::string resolved = instance.empty() ? "opaque" : fmt::format("{}.opaque", instance);
  Reflections::In in{scene, surfaces.draws, surfaces.deformed, fog_alone(lighting.unoccluded())};
  in.lists.occlusion = lighting.occlusion;
  Reflections pass;
  pass.knobs = frame.knobs.get<Reflections::Knobs>();
  if (pass.traced(frame.facts, request))
    in.met = lights_off_camera(lighting);
  else
    in.picture =
        newest(frame.add(Resolve{}, {color, scene.width_px, scene.height_px, scene.samples}, resolved).resolved, color);
  in.has_sky = frame.facts.environment || request.neutral_light;
  in.seed = request.still_seed;
  return frame.add(Reflections{}, in, instance).reflected;
}

// Surfaces that let light through, over all that is seen through them.
void refract(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
             Composite& over, std::string_view instance) {
  const std::string name = instance.empty() ? "refraction" : fmt::format("{}.refraction", instance);
  if (const Need need = Refraction{}.needed(frame.facts, frame.request); !need) {
    frame.add(Refraction{}, {}, instance);
    return;
  }
  const Lighting lists = of_blended(lighting.unoccluded());
  over.depth = frame.add(DepthPrepass{true}, {scene, surfaces.visible, surfaces.deformed}, name).depth;
  const Transparent::In blended{scene,          surfaces.visible, surfaces.deformed, lists,
                                surfaces.depth, over.radiance,    over.depth};
  const std::string behind = instance.empty() ? "behind" : fmt::format("{}.behind", instance);
  ImageHandle& color = over.radiance;
  color = newest(frame.add(Transparent{.behind = true}, blended, behind).color, color);
  const Resolve::In resolve{color, scene.width_px, scene.height_px, scene.samples};
  const ImageHandle picture = newest(frame.add(Resolve{}, resolve, name).resolved, color);
  Refraction pass;
  pass.knobs = frame.knobs.get<Refraction::Knobs>();
  Refraction::In in{.scene = scene,
                    .draws = surfaces.visible,
                    .deformed = surfaces.deformed,
                    .lists = lists,
                    .depth = over.depth,
                    .behind = surfaces.depth,
                    .picture = picture,
                    .color = color};
  if (pass.traced(frame.facts, frame.request)) in.met = lights_off_camera(lighting);
  in.bodies = frame.facts.refracting_bodies > 0;
  in.shows_sky = bool(Sky{}.needed(frame.facts, frame.request));
  const Refraction::Out made = frame.add(Refraction{}, in, instance);
  color = newest(made.color, color);
  over.seen = made.seen;
}

}  // namespace

Composite composite(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                    const Shaded& shaded, std::string_view instance) {
  const ImageHandle depth = surfaces.depth;
  Composite out;
  ImageHandle color = shaded.color;
  if (shaded.has_background) {
    if (is_first_picture(instance))
      for (const std::string_view pass : {Sky::name, Background::name})
        frame.builder.leave_out(std::string(pass), "surfaces are shaded with what is behind them (shade_visible)");
  } else {
    const Lighting fog = fog_to_infinity(lighting.unoccluded());
    color = newest(frame.add(Sky{}, {scene, depth, color, fog}, instance).color, color);
    color = newest(frame.add(Background{}, {scene, depth, color, fog}, instance).color, color);
  }
  if (shaded.whole) {
    out.radiance = shaded.color;
    out.depth = depth;
    out.resolved = true;
    return out;
  }
  out.reflected = reflections(frame, scene, surfaces, lighting, color, instance);
  color = newest(frame.add(ReflectionsOver{}, {scene, out.reflected, depth, color}, instance).color, color);
  out.radiance = color;
  out.depth = depth;
  refract(frame, scene, surfaces, lighting, out, instance);
  out.radiance = transparent(
      frame, {scene, surfaces.visible, surfaces.deformed, of_blended(lighting.unoccluded()), out.depth, out.radiance},
      instance);
  return out;
}

}  // namespace candela
