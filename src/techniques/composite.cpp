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

// Whether nothing is drawn over the surfaces but what they reflect.
bool reflects_last(const Frame& frame) {
  return frame.facts.blend_items == 0 && !Refraction{}.needed(frame.facts, frame.request);
}

// What surfaces reflect, added to the picture.
void reflect(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
             Composite& over, std::string_view instance) {
  const FrameRequest& request = frame.request;
  if (const Need need = Reflections{}.needed(frame.facts, request); !need) {
    frame.add(Reflections{}, {}, instance);
    frame.add(ReflectionsOver{}, {}, instance);
    return;
  }
  Reflections pass;
  pass.knobs = frame.knobs.get<Reflections::Knobs>();
  const bool is_traced = pass.traced(frame.facts, request);
  ImageHandle& color = over.radiance;
  ImageHandle picture = color;
  const bool last = reflects_last(frame);
  if (!over.resolved && (last || !is_traced)) {
    const Resolve::In samples{color, scene.width_px, scene.height_px, scene.samples};
    picture =
        newest(frame.add(Resolve{}, samples, instance.empty() ? "opaque" : fmt::format("{}.opaque", instance)).resolved,
               color);
  }
  Reflections::In in{scene, surfaces.draws, surfaces.deformed, fog_alone(lighting.unoccluded())};
  in.lists.occlusion = lighting.occlusion;
  if (lighting.occlusion.traced) {  // as the surfaces were shaded: rays for occlusion, and for no light
    in.lists.rays = lighting.rays;
    in.lists.rays.suns = in.lists.rays.lamps = false;
  }
  in.keys = keys_of_middles(frame, scene, surfaces, "reflections", instance);
  if (is_traced)
    in.met = lights_off_camera(lighting);
  else
    in.picture = picture;
  in.has_sky = frame.facts.environment || request.neutral_light;
  in.seed = request.still_seed;
  over.reflected = frame.add(Reflections{}, in, instance).reflected;
  ReflectionsOver::In added{scene, over.reflected, {surfaces.depth, {}}, color};
  over.resolved |= last;
  if (over.resolved) added.depth = surfaces.looked_up, added.color = picture, added.whole = true;
  color = newest(frame.add(ReflectionsOver{}, added, instance).color, added.color);
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
  out.radiance = color;
  out.depth = depth;
  out.resolved = shaded.whole;
  reflect(frame, scene, surfaces, lighting, out, instance);
  refract(frame, scene, surfaces, lighting, out, instance);
  out.radiance = transparent(
      frame, {scene, surfaces.visible, surfaces.deformed, of_blended(lighting.unoccluded()), out.depth, out.radiance},
      instance);
  return out;
}

}  // namespace candela
