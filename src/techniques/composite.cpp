#include "techniques/technique.h"

namespace candela {
namespace {

Reflected reflections(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                      ImageHandle color, std::string_view instance) {
  const FrameRequest& request = frame.request;
  if (const Need need = Reflections{}.needed(frame.facts, request); !need)
    return frame.add(Reflections{}, {}, instance).reflected;
  const std::string resolved = instance.empty() ? "opaque" : fmt::format("{}.opaque", instance);
  Reflections::In in{scene, surfaces.draws, surfaces.deformed, fog_alone(lighting.lists)};
  in.lists.occlusion = lighting.occlusion;
  in.picture =
      newest(frame.add(Resolve{}, {color, scene.width_px, scene.height_px, scene.samples}, resolved).resolved, color);
  in.has_sky = frame.facts.environment || request.neutral_light;
  in.seed = request.still_seed;
  in.subsample = scene.subsample, in.subsamples = scene.subsamples;
  return frame.add(Reflections{}, in, instance).reflected;
}

}  // namespace

Composite composite(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                    ImageHandle shaded, std::string_view instance) {
  const auto& [draws, deformed, depth] = surfaces;
  Composite out;
  ImageHandle color =
      newest(frame.add(Sky{}, {scene, depth, shaded, fog_to_infinity(lighting.lists)}, instance).color, shaded);
  color =
      newest(frame.add(Background{}, {scene, depth, color, fog_to_infinity(lighting.lists)}, instance).color, color);
  out.reflected = reflections(frame, scene, surfaces, lighting, color, instance);
  color = newest(frame.add(ReflectionsOver{}, {scene, out.reflected, depth, color}, instance).color, color);
  out.radiance = newest(
      frame.add(Transparent{}, {scene, draws, deformed, of_blended(lighting.lists), depth, color}, instance).color,
      color);
  return out;
}

}  // namespace candela
