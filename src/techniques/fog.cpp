#include "passes/volumes/fog.h"
#include "passes/post/resolve.h"
#include "passes/shared/blended.h"
#include "passes/shared/fog_view.h"
#include "passes/shared/light_lists.h"
#include "passes/shared/scene_inputs.h"
#include "passes/volumes/fog_knobs.h"
#include "passes/volumes/fog_layers.h"
#include "passes/volumes/fog_march.h"
#include "techniques/technique.h"

namespace candela {

FogView fog_view(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting) {
  FogView fog;
  const bool ambient = frame.facts.environment || frame.request.neutral_light;
  const Look& look = frame.request.look;
  fog.media = int(summed_fog(look));
  fog.grid =
      frame.add(FogGrid{.has_suns = bool(lighting.sun_maps)}, {scene, lighting.unoccluded(), ambient, fog.media}).light;
  const FogKnobs& knobs = frame.knobs.get<FogKnobs>();
  FogMarch march;
  march.shared_knobs = knobs;
  const ImageHandle texels =
      frame.add(march, {scene, lighting.unoccluded(), surfaces.looked_up, ambient, fog.media, frame.request.still_seed})
          .light;
  if (!frame.request.draws_fog()) return fog;
  fog.ambient = ambient;
  // Without lamps nothing in a slice is steep.
  const bool lamps = frame.facts.point_lights + frame.facts.spot_lights > 0;
  fog.last = knobs.last == FogKnobs::near_lamps && !lamps ? 0 : knobs.last;
  fog.lamp_points = knobs.local_shadows, fog.sun_points = knobs.sun_points;
  // What several media emit is summed with what they scatter.
  const bool sums_light =
      (fog_scatters(look) && (frame.facts.lights() > 0 || ambient)) || (fog.media > 0 && fog_glows(look));
  fog.light = fog.grid ? FogLight::grid : texels ? FogLight::texels : sums_light ? FogLight::march : FogLight::nothing;
  if (texels) fog.grid = texels;
  return fog;
}

Lighting fog_alone(const Lighting& lists) {
  Lighting alone;
  if (fog_walks(lists)) alone = lists;
  if (lists.fog.lamp_points == 0) alone.lamp_maps = alone.deep.lamps = {};
  alone.fog = lists.fog;
  return alone;
}

Lighting fog_to_infinity(const Lighting& lists) {
  Lighting far = lists;
  far.fog.last = 0;
  return fog_alone(far);
}

FogImages fog_layers(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                     const Composite& composite, std::string_view instance) {
  Lighting lists = fog_alone(lighting.unoccluded());
  if (fog_walks(of_blended(lighting.unoccluded()))) lists = lighting.unoccluded();
  FogLayers::In in{scene, surfaces.visible, surfaces.deformed, lists, surfaces.depth, {}};
  if (composite.seen) in.nearest = composite.depth;
  for (size_t i = 0; i < in.wanted.size(); ++i) in.wanted[i] = frame.request.has_layer(FogLayers::layers[i].name);
  in.without_blended = stores_blended(frame);
  FogImages images = frame.add(FogLayers{}, in, instance).images;
  if (!in.without_blended) return images;
  BlendedIn over{scene, surfaces.visible, surfaces.deformed, of_blended(lighting.unoccluded()), composite.depth, {}};
  for (size_t i = 0; i < images.size(); ++i) {
    over.color = images[i];
    if (images[i])
      images[i] = part_behind_blended(frame, over, FogLayers::stored_part(i), FogLayers::layers[i].name, instance);
  }
  return images;
}

void publish_fog(Frame& frame, const SceneInputs& scene, const FogImages& images) {
  const SubframePart::Role role = frame.request.part.role;
  for (size_t i = 0; i < images.size(); ++i) {
    const std::string layer(FogLayers::layers[i].name);
    if (role == SubframePart::Role::mean && frame.request.has_layer(layer) && frame.request.draws_fog())
      frame.builder.publish(layer, mean_of(frame, scene, layer));
    const bool summed =
        role == SubframePart::Role::subframe && frame.request.has_layer(layer) && frame.request.draws_fog();
    if (!images[i] && !summed) continue;
    ImageHandle resolved = images[i];
    if (resolved) {
      const Resolve::In in{resolved, scene.width_px, scene.height_px, scene.samples};
      resolved = newest(frame.add(Resolve{}, in, layer).resolved, resolved);
    }
    if (summed)
      add_to_sum(frame, scene, layer, resolved);
    else
      frame.builder.publish(layer, resolved);
  }
}

}  // namespace candela
