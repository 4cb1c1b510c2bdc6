#include <cmath>

#include "passes/geometry/metaballs.h"
#include "passes/geometry/pose_items.h"
#include "passes/lights/pose_lights.h"
#include "passes/post/supersample.h"
#include "passes/shared/features.h"
#include "passes/shared/light_lists.h"
#include "passes/shared/scene_inputs.h"
#include "passes/surfaces/terms.h"
#include "passes/volumes/fog_layers.h"
#include "techniques/technique.h"

namespace candela {
namespace {

// One of the frames of a picture, which has its own places in the pixels and its own part of all samples.
void become_subframe(SceneInputs& scene, const SubframePart& part) {
  scene.is_subsample = true;
  scene.features = with_subsample(std::move(scene.features));
  scene.subsamples = part.count;
}

// The mean of a grid of pictures, each from its own point of every pixel. Lists of lights by tiles follow the depth and
// are made for each picture, those by clusters serve all. Ambient occlusion too is made for each, with a part of its
// samples. Terms are summed as their pictures are.
ImageHandle supersampled(Frame& frame, const SceneInputs& scene, const Technique& technique, const Surfaces& surfaces,
                         const Lighting& lighting, glm::uvec2 grid, TermImages& terms, LightGroupImages& lights,
                         FogImages& fog, MatteImages& mattes) {
  SceneInputs sample = scene;
  sample.is_subsample = true;
  sample.features = with_subsample(scene.features);
  const uint32_t pictures = grid.x * grid.y;
  sample.subsample_footprint = 1 / std::sqrt(float(pictures));
  sample.supersamples = pictures, sample.supersample_grid = grid;
  sample.subsamples = scene.subsamples * pictures;
  ImageHandle sum;
  const bool divided = bool(Terms{}.needed(frame.facts, frame.request));
  if (!divided) frame.add(Terms{}, {});
  const bool foggy = bool(FogLayers{}.needed(frame.facts, frame.request));
  if (!foggy) frame.add(FogLayers{}, {});
  const auto add = [&](ImageHandle picture, ImageHandle before, const std::string& of) {
    return frame.add(Supersample{}, {picture, before, scene.width_px, scene.height_px}, of).sum;
  };
  for (uint32_t i = 0; i < pictures; ++i) {
    const std::string instance = fmt::format("s{:02}", i);
    sample.supersample = i;
    sample.supersample_px = subsample_offset_px(grid, i);
    const Surfaces seen = seen_again(frame, sample, surfaces, instance);
    Lighting lit = lighting;
    if (scene.light_grid.tiled) lit = lighting.with_cells(light_cells(frame, sample, seen, instance));
    if (shades_occluded(frame)) lit.occlusion = ambient_occlusion(frame, sample, seen.looked_up, instance);
    const Shaded shaded = technique.shade(frame, sample, seen, lit, instance);
    const Composite seen_all = composite(frame, sample, seen, lit, shaded, instance);
    sum = add(seen_all.radiance, sum, instance);
    if (foggy) {
      const FogImages parts = fog_layers(frame, sample, seen, lit, seen_all, instance);
      for (size_t l = 0; l < parts.size(); ++l)
        if (parts[l]) fog[l] = add(parts[l], fog[l], fmt::format("{}.{}", instance, FogLayers::layers[l].name));
    }
    const LightGroupImages groups = divide_lights(frame, sample, seen, lit, seen_all, instance);
    lights.resize(groups.size());
    for (size_t g = 0; g < groups.size(); ++g)
      if (groups[g])
        lights[g] = add(groups[g], lights[g], fmt::format("{}.{}", instance, frame.request.light_groups[g]));
    matte_ids(frame, sample, seen, mattes, instance);
    if (!divided) continue;
    const TermImages parts = divide(frame, sample, seen, lit, seen_all, instance);
    for (uint32_t t = 0; t < term_count; ++t)
      if (parts[t]) terms[t] = add(parts[t], terms[t], fmt::format("{}.{}", instance, Terms::layers[t].name));
  }
  return sum;
}

}  // namespace

void build_frame(Frame& frame, const SceneInputs& inputs, const Technique& technique) {
  SceneInputs scene = inputs;
  const PoseItems::Out items = frame.add(PoseItems{.on_device = scene.item_group_count > 0}, {scene});
  if (scene.item_group_count > 0)
    scene.transforms = items.transforms, scene.items = items.items, scene.batches = items.batches,
    scene.places = items.places;
  const MetaballPolygons::Out polygons = frame.add(MetaballPolygons{}, {scene});
  scene.items = newest(polygons.items, scene.items);
  scene.polygons = polygons.vertices, scene.polygons_before = polygons.before;
  const BufferHandle posed = frame.add(PoseLights{.on_device = scene.light_group_count > 0}, {scene}).lights;
  if (scene.light_group_count > 0) scene.lights = posed;
  if (frame.request.part.role == SubframePart::Role::subframe) become_subframe(scene, frame.request.part);
  const Supersample::Knobs& supersample = frame.knobs.get<Supersample::Knobs>();
  const uint32_t pictures = supersample.pictures();
  const Surfaces surfaces = visible_surfaces(frame, scene);
  const auto [lighting, occlusion] = light_surfaces(frame, scene, surfaces, pictures);
  ImageHandle radiance;
  bool resolved = false;
  TermImages terms;
  LightGroupImages lights;
  FogImages fog;
  MatteImages mattes;
  if (frame.request.part.role == SubframePart::Role::mean) {
    matte_ids(frame, scene, surfaces, mattes);
  } else if (pictures > 1) {
    radiance =
        supersampled(frame, scene, technique, surfaces, lighting, supersample.grid(), terms, lights, fog, mattes);
  } else {
    frame.add(Supersample{}, {});
    const Composite all =
        composite(frame, scene, surfaces, lighting, technique.shade(frame, scene, surfaces, lighting, {}));
    radiance = all.radiance;
    resolved = all.resolved;
    terms = divide(frame, scene, surfaces, lighting, all);
    lights = divide_lights(frame, scene, surfaces, lighting, all);
    fog = fog_layers(frame, scene, surfaces, lighting, all);
    matte_ids(frame, scene, surfaces, mattes);
  }
  describe(frame, scene, surfaces, lighting, occlusion);
  terms = publish_terms(frame, scene, terms);
  publish_light_groups(frame, scene, lights);
  publish_fog(frame, scene, fog);
  publish_mattes(frame, scene, mattes, pictures);
  post(frame, scene, surfaces, lighting, radiance, resolved, terms[size_t(Term::emission)]);
}

}  // namespace candela
