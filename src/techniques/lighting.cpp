#include "techniques/technique.h"

namespace candela {
namespace {

CellLists light_lists(Frame& frame, const SceneInputs& scene, ImageHandle depth, std::string_view instance) {
  const LightGridShape& grid = scene.light_grid;
  const BufferHandle tiles = frame.add(TileDepth{grid}, {scene, depth}, instance).tiles;
  const LightAssign::Out assigned = frame.add(LightAssign{grid}, {scene, tiles}, instance);
  const BufferHandle offsets = frame.add(LightScan{grid}, {assigned.lists, assigned.sums}, instance).offsets;
  const BufferHandle unsorted = frame.add(LightFill{grid}, {scene, offsets, assigned.hits}, instance).unsorted;
  const BufferHandle entries = frame.add(LightSort{grid}, {offsets, unsorted}, instance).entries;
  return {grid.compact ? offsets : assigned.lists, entries, tiles};
}

// What the views of an image show, drawn into it or kept from before; without the image the reason why it is not there.
ImageHandle depth_maps(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces,
                       const std::shared_ptr<const ViewImage>& image, const std::optional<Hash128>& key,
                       ViewRange views, const std::string& absence, std::string_view instance) {
  if (!image) {
    ImageHandle none;
    none.absence = frame.builder.leave_out(fmt::format("{}.{}", DepthViews::name, instance), absence);
    return none;
  }
  const Frame::Kept maps = frame.keep(image_desc(*image, depth_format), key);
  if (maps.filled) {
    for (const std::string_view pass : {Cull::name, CullCompact::name, DepthViews::name})
      frame.builder.leave_out(fmt::format("{}.{}", pass, instance), "kept from before: nothing that casts has moved");
    return maps.image;
  }
  views.count = uint32_t(image->views.size());
  const Cull::Out culled = frame.add(Cull{}, {scene, views}, instance);
  if (scene.batch_count > 0)
    return frame.add(RasterizeViews{}, {scene, views, culled.masks, surfaces.deformed, image, maps.image}, instance)
        .depth;
  const Draws draws = frame.add(CullCompact{}, {scene, culled.masks, culled.survivors, views}, instance).draws;
  return frame.add(DepthViews{}, {scene, draws, surfaces.deformed, image, maps.image}, instance).depth;
}

}  // namespace

ImageHandle sun_maps(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces) {
  const ViewRange views{scene.views, scene.view_regions, 0, 0, scene.view_first_command};
  return depth_maps(frame, scene, surfaces, scene.sun_image, scene.sun_key, views, scene.sun_absence, "sun");
}

ImageHandle lamp_maps(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces) {
  const ViewRange views{scene.lamp_views, scene.lamp_view_regions, 0, 0, scene.lamp_first_command};
  return depth_maps(frame, scene, surfaces, scene.lamp_image, scene.lamp_key, views, scene.lamp_absence, "lamps");
}

OcclusionTexels ambient_occlusion(Frame& frame, const SceneInputs& scene, const SampledDepth& depth,
                                  std::string_view instance, uint32_t index, uint32_t count) {
  AmbientOcclusion pass;
  pass.knobs = frame.knobs.get<AmbientOcclusion::Knobs>();
  AmbientOcclusion::In in{scene, depth};
  in.look = frame.request.look.occlusion.value_or(Occlusion{});
  in.seed = frame.request.still_seed;
  in.subsample = index, in.subsamples = count;
  return {frame.add(pass, in, instance).open, pass.shape(scene), pass.traced(frame.facts, frame.request)};
}

bool shades_occluded(const Frame& frame) { return bool(AmbientOcclusion::shades(frame.facts, frame.request)); }

Lighting light_surfaces(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, std::string_view instance) {
  return {light_lists(frame, scene, surfaces.depth, instance)};
}

}  // namespace candela
