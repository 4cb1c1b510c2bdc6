#include "passes/geometry/cull.h"
#include "passes/geometry/cull_compact.h"
#include "passes/geometry/depth_views.h"
#include "passes/geometry/rasterize.h"
#include "passes/lights/light_assign.h"
#include "passes/lights/light_bounds.h"
#include "passes/lights/light_fill.h"
#include "passes/lights/light_scan.h"
#include "passes/lights/light_sort.h"
#include "passes/lights/tile_depth.h"
#include "passes/occlusion/occlusion.h"
#include "passes/shadows/light_voxels.h"
#include "passes/shared/frame_request.h"
#include "passes/shared/knob_values.h"
#include "passes/shared/light_lists.h"
#include "passes/shared/sampled_depth.h"
#include "passes/shared/scene_inputs.h"
#include "passes/shared/views.h"
#include "passes/transparency/colored_shadows.h"
#include "passes/transparency/deep_shadows.h"
#include "techniques/technique.h"

namespace candela {
namespace {

Lighting light_lists(Frame& frame, const SceneInputs& scene, ImageHandle depth, std::string_view instance) {
  const LightGridShape& grid = scene.light_grid;
  const BufferHandle tiles = frame.add(TileDepth{grid}, {scene, depth}, instance).tiles;
  LightBoxes boxes{scene.light_bounds, scene.light_chunks, scene.light_dispatch};
  const LightBoxes found = frame.add(LightBoundsPass{grid}, {scene}, instance).boxes;
  if (grid.most_bounds > 0) boxes = found;
  const LightAssign::Out assigned = frame.add(LightAssign{grid}, {scene, boxes, tiles}, instance);
  const LightScan::Out scanned = frame.add(LightScan{grid}, {assigned.lists, assigned.sums}, instance);
  const BufferHandle offsets = scanned.offsets;
  const BufferHandle filled =
      frame.add(LightFill{grid}, {scene, boxes, offsets, assigned.hits, scanned.rows}, instance).entries;
  const BufferHandle entries = newest(frame.add(LightSort{grid}, {offsets, filled}, instance).entries, filled);
  return {grid.compact ? offsets : assigned.lists, entries, tiles};
}

// What the views of an image show, drawn or kept from before; without the image the reason why it is not there.
// And what see-through surfaces leave of the light (ColoredShadows, DeepShadows), where maps are drawn. as_depth:
// samplers compare with the image or passes draw over it; otherwise depths from compute are plain floats, which a GPU
// copies faster.
struct LightMaps {
  ImageHandle depth, colors, deep;
};
LightMaps light_maps(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces,
                     const std::shared_ptr<const ViewImage>& image, const std::optional<Hash128>& key, ViewRange views,
                     bool as_depth, const std::string& absence, std::string_view instance) {
  LightMaps out;
  if (!image) {
    out.depth.absence = frame.builder.leave_out(fmt::format("{}.{}", DepthViews::name, instance), absence);
    for (const std::string_view pass : {RasterizeViews::name, ColoredShadows::name, DeepShadows::name})
      frame.builder.leave_out(fmt::format("{}.{}", pass, instance), absence);
    return out;
  }
  const bool in_compute = scene.batch_count > 0;
  frame.builder.leave_out(fmt::format("{}.{}", in_compute ? DepthViews::name : RasterizeViews::name, instance),
                          in_compute ? "shadow maps are drawn in compute (rasterize_views)"
                                     : "the hardware draws shadow maps (depth_views)");
  const bool floats = in_compute && !as_depth;
  views.image = image, views.commands = image->commands;
  const Cull::Out culled = frame.add(Cull{}, {scene, views}, instance);
  const Draws draws = frame.add(CullCompact{}, {scene, culled.masks, culled.survivors, views}, instance).draws;
  if (in_compute)
    out.depth =
        frame.add(RasterizeViews{}, {scene, views, culled.masks, surfaces.deformed, image, floats}, instance).depth;
  else
    out.depth = frame.add(DepthViews{}, {scene, draws, surfaces.deformed, image}, instance).depth;
  if (image->apart && out.depth) frame.builder.pool(out.depth);
  if (key && out.depth) frame.builder.keep(out.depth, *key, "kept from before: nothing that casts has moved");
  const ColoredShadows::In in{scene, draws, surfaces.deformed, image, out.depth, frame.facts.refracting_bodies > 0};
  out.colors = frame.add(ColoredShadows{}, in, instance).colors;
  out.deep = frame.add(DeepShadows{}, {scene, draws, surfaces.deformed, image, out.depth}, instance).deep;
  return out;
}

}  // namespace

bool draws_shadow_colors(const SceneFacts& facts, const FrameRequest& request, const KnobValues& knobs) {
  return ColoredShadows{knobs.get<ColoredShadows::Knobs>()}.needed(facts, request) ||
         DeepShadows{knobs.get<DeepShadows::Knobs>()}.needed(facts, request);
}

void shadow_maps(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, Lighting& lighting) {
  const auto maps = [&](auto image, auto key, const ViewRange& views, bool as_depth, auto absence,
                        std::string_view instance) {
    return light_maps(frame, scene, surfaces, image, key, views, as_depth, absence, instance);
  };
  const LightMaps suns =
      maps(scene.sun_image, scene.sun_key, {scene.views, scene.view_regions, 0, 0, {}, scene.view_first_command, 0, {}},
           true, scene.sun_absence, "sun");
  const LightMaps lamps =
      maps(scene.lamp_image, scene.lamp_key,
           {scene.lamp_views, scene.lamp_view_regions, 0, 0, {}, scene.lamp_first_command, 0, scene.moving},
           draws_shadow_colors(frame.facts, frame.request, frame.knobs), scene.lamp_absence, "local");
  lighting.sun_maps = suns.depth, lighting.lamp_maps = lamps.depth;
  // Rays tell themselves what is left of a light.
  if (!scene.rays.suns) lighting.shadow_colors.suns = suns.colors;
  if (!scene.rays.lamps) lighting.shadow_colors.lamps = lamps.colors;
  lighting.deep = {suns.deep, lamps.deep};
  lighting.shadow_colors.bent = frame.facts.refracting_bodies > 0 && frame.knobs.get<ColoredShadows::Knobs>().steps > 0;
}

OcclusionTexels ambient_occlusion(Frame& frame, const SceneInputs& scene, const SampledDepth& depth,
                                  std::string_view instance) {
  AmbientOcclusion pass;
  pass.knobs = frame.knobs.get<AmbientOcclusion::Knobs>();
  AmbientOcclusion::In in{scene, depth};
  in.look = Live<Occlusion>::of(frame.values.occlusion);
  in.seed = frame.request.still_seed;
  return {frame.add(pass, in, instance).open, pass.shape(scene), pass.traced(frame.facts, frame.request)};
}

LightVoxels light_voxels(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lists) {
  return frame
      .add(FillLightVoxels{.wanted = scene.rays.suns_by_voxels || scene.rays.lamps_by_voxels},
           {scene, lists, surfaces.looked_up})
      .voxels;
}

bool shades_occluded(const Frame& frame) { return bool(AmbientOcclusion::shades(frame.facts, frame.request)); }

Lighting light_cells(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, std::string_view instance) {
  return light_lists(frame, scene, surfaces.depth, instance);
}

FrameLighting light_surfaces(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, uint32_t pictures) {
  Lighting lighting = light_cells(frame, scene, surfaces);
  // Of a supersampled frame only the layer is of this depth. Before the suns' maps, which are drawn meanwhile.
  OcclusionTexels occlusion;
  if (pictures == 1 || frame.request.has_layer("occlusion") || !shades_occluded(frame))
    occlusion = ambient_occlusion(frame, scene, surfaces.looked_up);
  if (pictures == 1 && shades_occluded(frame)) lighting.occlusion = occlusion;
  lighting.rays = scene.rays;
  lighting.rays.surfaces = false;  // not where the camera's surfaces are shaded
  lighting.rays.trees = scene.trees, lighting.rays.settings = scene.ray_settings;
  lighting.voxels = light_voxels(frame, scene, surfaces, lighting.unoccluded());
  shadow_maps(frame, scene, surfaces, lighting);
  lighting.fog = fog_view(frame, scene, surfaces, lighting);
  return {lighting, occlusion};
}

}  // namespace candela
