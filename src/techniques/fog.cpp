#include "techniques/technique.h"

namespace candela {

FogView fog_view(Frame& frame, const SceneInputs& scene, const Lighting& lighting) {
  FogView fog;
  const bool ambient = frame.facts.environment || frame.request.neutral_light;
  fog.grid = frame.add(FogGrid{}, {scene, lighting.lists, ambient}).light;
  if (!frame.request.draws_fog()) return fog;
  const bool scatters = frame.request.look.fog->scattering_per_m != glm::dvec3(0);
  fog.ambient = ambient;
  fog.last = frame.knobs.get<FogKnobs>().last != 0;
  fog.lamp_points = frame.knobs.get<FogKnobs>().lamp_shadows;
  fog.light = fog.grid                                            ? FogLight::grid
              : scatters && (frame.facts.lights() > 0 || ambient) ? FogLight::march
                                                                  : FogLight::nothing;
  return fog;
}

CellLists fog_alone(const CellLists& lists) {
  CellLists alone;
  if (fog_walks(lists)) alone = lists;
  if (lists.fog.lamp_points == 0) alone.lamp_maps = {};
  alone.fog = lists.fog;
  return alone;
}

CellLists fog_to_infinity(const CellLists& lists) {
  CellLists far = lists;
  far.fog.last = false;
  return fog_alone(far);
}

FogImages fog_layers(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                     std::string_view instance) {
  FogLayers::In in{scene, surfaces.draws, surfaces.deformed, fog_alone(lighting.lists), surfaces.depth, {}};
  for (size_t i = 0; i < in.wanted.size(); ++i) in.wanted[i] = frame.request.has_layer(FogLayers::layers[i].name);
  return frame.add(FogLayers{}, in, instance).images;
}

void publish_fog(Frame& frame, const SceneInputs& scene, const FogImages& images) {
  for (size_t i = 0; i < images.size(); ++i) {
    if (!images[i]) continue;
    const std::string layer(FogLayers::layers[i].name);
    const Resolve::In in{images[i], scene.width_px, scene.height_px, scene.samples};
    frame.builder.publish(layer, newest(frame.add(Resolve{}, in, layer).resolved, images[i]));
  }
}

}  // namespace candela
