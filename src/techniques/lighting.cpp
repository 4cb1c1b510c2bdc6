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

}  // namespace

ImageHandle sun_maps(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces) {
  constexpr std::string_view instance = "sun";
  if (!scene.sun_image) {
    ImageHandle none;
    none.absence = frame.builder.leave_out(std::string(DepthViews::name) + ".sun", scene.sun_absence);
    return none;
  }
  const Frame::Kept maps = frame.keep(DepthViews::image_desc(*scene.sun_image), scene.sun_key);
  if (maps.filled) {
    for (const std::string_view pass : {Cull::name, CullCompact::name, DepthViews::name})
      frame.builder.leave_out(fmt::format("{}.{}", pass, instance), "kept from before: nothing that casts has moved");
    return maps.image;
  }
  const ViewRange views{scene.views, scene.view_regions, 0, uint32_t(scene.sun_image->views.size()),
                        scene.view_first_command};
  const Cull::Out culled = frame.add(Cull{}, {scene, views}, instance);
  const Draws draws = frame.add(CullCompact{}, {scene, culled.masks, culled.survivors, views}, instance).draws;
  return frame.add(DepthViews{}, {scene, draws, surfaces.deformed, scene.sun_image, maps.image}, instance).depth;
}

OcclusionTexels ambient_occlusion(Frame& frame, const SceneInputs& scene, ImageHandle depth, std::string_view instance,
                                  uint32_t index, uint32_t count) {
  AmbientOcclusion pass;
  pass.knobs = frame.knobs.get<AmbientOcclusion::Knobs>();
  AmbientOcclusion::In in{scene, depth};
  in.look = frame.request.look.occlusion.value_or(Occlusion{});
  in.seed = frame.request.still_seed;
  in.subsample = index, in.subsamples = count;
  return {frame.add(pass, in, instance).open, pass.shape(scene)};
}

bool shades_occluded(const Frame& frame) { return bool(AmbientOcclusion::shades(frame.facts, frame.request)); }

Lighting light_surfaces(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, std::string_view instance) {
  return {light_lists(frame, scene, surfaces.depth, instance)};
}

}  // namespace candela
