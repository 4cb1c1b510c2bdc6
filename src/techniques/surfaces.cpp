#include "passes/debug/layers.h"
#include "passes/debug/light_heat.h"
#include "passes/debug/light_volume_layer.h"
#include "passes/debug/motion.h"
#include "passes/debug/tree_views.h"
#include "passes/geometry/cull.h"
#include "passes/geometry/cull_compact.h"
#include "passes/geometry/deform.h"
#include "passes/geometry/depth_prepass.h"
#include "passes/geometry/depth_pyramid.h"
#include "passes/geometry/key_depth.h"
#include "passes/geometry/occlusion_cull.h"
#include "passes/geometry/occlusion_cull_knobs.h"
#include "passes/geometry/rasterize.h"
#include "passes/geometry/trace_keys.h"
#include "passes/lights/light_volumes.h"
#include "passes/occlusion/occlusion_layer.h"
#include "passes/post/supersample.h"
#include "passes/reflections/reflections.h"
#include "passes/shadows/local_layers.h"
#include "passes/shadows/sun_layers.h"
#include "passes/shared/draw_batches.h"
#include "passes/shared/frame_request.h"
#include "passes/shared/light_lists.h"
#include "passes/shared/pass.h"
#include "passes/shared/scene_inputs.h"
#include "passes/shared/views.h"
#include "passes/shared/volume_lists.h"
#include "passes/surfaces/refraction.h"
#include "passes/transparency/phenomenological.h"
#include "techniques/technique.h"

namespace candela {

namespace {

// What culling keeps, as hardware draws it and as compute rasterizes it.
struct Kept {
  Draws draws;
  BufferHandle masks;
};

std::string part_of(std::string_view instance, std::string_view part) {
  return instance.empty() ? std::string(part) : fmt::format("{}.{}", instance, part);
}

// Adds the triangles of what is kept to those whose depths are known, and, by hardware, its lines and points.
void find_depths(Frame& frame, const SceneInputs& scene, const Kept& kept, Surfaces& surfaces,
                 std::string_view instance) {
  if (scene.batch_count > 0) {
    Rasterize::In in{scene, kept.masks, surfaces.deformed};
    in.masks_by_sample = frame.knobs.get<DepthPrepass::Knobs>().by_sample != 0;
    in.keys = surfaces.keys;
    surfaces.keys = frame.add(Rasterize{}, in, instance).keys;
    surfaces.looked_up = {{}, surfaces.keys};
  } else {
    surfaces.depth = frame.add(DepthPrepass{}, {scene, kept.draws, surfaces.deformed, surfaces.depth}, instance).depth;
    surfaces.looked_up = {surfaces.depth, {}};
  }
}

Need needs_two_phases(const Frame& frame, const SceneInputs& scene) {
  const OcclusionCullKnobs& knobs = frame.knobs.get<OcclusionCullKnobs>();
  if (knobs.mode == OcclusionCullKnobs::automatic && scene.batch_count > 0)
    return {false, "compute rasterizes hidden triangles at little cost (occlusion_cull.mode)"};
  return needs_occlusion_culling(frame.facts, knobs);
}

// The same in two phases, the second without what the first hides.
void find_visible_depths(Frame& frame, const SceneInputs& scene, Surfaces& surfaces, std::string_view instance) {
  const auto compact = [&](BufferHandle masks, BufferHandle survivors, std::string_view part) {
    return Kept{frame.add(CullCompact{}, {scene, masks, survivors}, part_of(instance, part)).draws, masks};
  };
  const Occluders::Out occluders = frame.add(Occluders{}, {scene, surfaces.kept_items}, instance);
  find_depths(frame, scene, compact(occluders.masks, occluders.survivors, "occluders"), surfaces,
              part_of(instance, "occluders"));
  const DepthPyramid::In depths{scene.constants, surfaces.looked_up, scene.width_px, scene.height_px, scene.samples};
  OcclusionCull::In in{scene, surfaces.kept_items, occluders.masks};
  in.pyramid = frame.add(DepthPyramid{}, depths, instance).pyramid;
  // Of a supersampled frame the first picture's: the frame's own depth is there for what looks it up alone.
  in.reports = frame.knobs.get<Supersample::Knobs>().n > 1 ? instance == "s00" : instance.empty();
  const OcclusionCull::Out culled = frame.add(OcclusionCull{}, in, instance);
  surfaces.visible = compact(culled.visible, culled.visible_survivors, "visible").draws;
  find_depths(frame, scene, compact(culled.rest, culled.rest_survivors, "rest"), surfaces, instance);
}

// Whether nothing asks for depths but blended surfaces, where they are drawn. What bends light or reflects looks
// beside them, and layers look everywhere.
bool tests_blended_alone(const Frame& frame, const SceneInputs& scene) {
  const FrameRequest& request = frame.request;
  return frame.facts.blend_items > 0 && request.transparency != Phenomenological::method && request.layers.empty() &&
         request.view == "beauty" && !request.wants_term("emission") && !draws_lines(scene) &&
         !Refraction{}.needed(frame.facts, request) && !Reflections{}.needed(frame.facts, request);
}

// Depths of the surfaces, and, where compute rasterizes triangles, which are seen.
void find_nearest(Frame& frame, const SceneInputs& scene, Surfaces& surfaces, std::string_view instance = {}) {
  surfaces.keys = {}, surfaces.depth = {};
  surfaces.visible = surfaces.draws;
  const auto leave_out = [&](std::string_view pass, std::string_view reason) {
    if (is_first_picture(instance)) frame.builder.leave_out(std::string(pass), std::string(reason));
  };
  const auto leave_out_occlusion_culling = [&](std::string_view reason) {
    for (const std::string_view pass : {Occluders::name, DepthPyramid::name, OcclusionCull::name})
      leave_out(pass, reason);
  };
  if (scene.triangle_numbers) {
    leave_out(Rasterize::name, "rays find what the camera sees (trace_keys)");
    leave_out_occlusion_culling("rays find what the camera sees (trace_keys)");
    surfaces.keys = frame.add(TraceKeys{}, {scene}, instance).keys;
    surfaces.looked_up = {{}, surfaces.keys};
  } else {
    leave_out(TraceKeys::name, scene.batch_count > 0
                                   ? "triangles are rasterized in compute (rasterize)"
                                   : "the hardware draws what the camera sees (--technique visibility, hybrid, ray)");
    if (const Need need = needs_two_phases(frame, scene)) {
      find_visible_depths(frame, scene, surfaces, instance);
    } else {
      leave_out_occlusion_culling(std::string(need.reason));
      find_depths(frame, scene, {surfaces.draws, surfaces.kept_items}, surfaces, instance);
    }
  }
  if (scene.batch_count == 0) {
    for (const std::string_view pass : {Rasterize::name, BlendedTiles::name, KeyDepth::name})
      leave_out(pass, "the hardware draws what the camera sees (--technique visibility, hybrid, ray)");
    return;
  }
  const bool in_tiles = frame.knobs.get<KeyDepth::Knobs>().tiles != 0 && tests_blended_alone(frame, scene);
  const BufferHandle tiles = frame.add(BlendedTiles{in_tiles}, {scene, surfaces.kept_items}, instance).tiles;
  surfaces.depth =
      frame.add(KeyDepth{}, {surfaces.keys, tiles, scene.width_px, scene.height_px, scene.samples}, instance).depth;
  if (!draws_lines(scene)) {
    leave_out(DepthPrepass::name, "keys of triangles tell depths (rasterize, trace_keys)");
    return;
  }
  DepthPrepass::In lines{scene, surfaces.visible, surfaces.deformed, surfaces.depth};
  lines.lines_alone = true;
  surfaces.depth = frame.add(DepthPrepass{}, lines, instance).depth;
  surfaces.looked_up = {surfaces.depth, {}};
}

}  // namespace

Surfaces visible_surfaces(Frame& frame, const SceneInputs& scene) {
  const Cull::Out culled = frame.add(Cull{}, {scene});
  Surfaces surfaces;
  surfaces.kept_items = culled.masks;
  surfaces.draws = frame.add(CullCompact{}, {scene, culled.masks, culled.survivors}).draws;
  surfaces.deformed = newest(frame.add(Deform{}, {scene, scene.polygons}).deformed, scene.polygons);
  find_nearest(frame, scene, surfaces);
  return surfaces;
}

Surfaces seen_again(Frame& frame, const SceneInputs& scene, Surfaces surfaces, std::string_view instance) {
  find_nearest(frame, scene, surfaces, instance);
  return surfaces;
}

BufferHandle keys_of_middles(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, std::string_view name,
                             std::string_view instance) {
  if (!surfaces.keys || draws_lines(scene)) return {};
  if (scene.samples == 1) return surfaces.keys;
  SceneInputs one = scene;
  one.samples = 1;
  if (scene.triangle_numbers) return frame.add(TraceKeys{}, {one}, part_of(instance, name)).keys;
  return frame.add(Rasterize{}, {one, surfaces.kept_items, surfaces.deformed}, part_of(instance, name)).keys;
}

ImageHandle depth_of_hardware(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, std::string_view name) {
  if (!surfaces.keys) return surfaces.depth;
  return frame.add(DepthPrepass{}, {scene, surfaces.visible, surfaces.deformed}, name).depth;
}

namespace {
// Deformed vertices of the time before; this one's where they are the same.
BufferHandle deformed_before(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces) {
  if (!scene.joints_before && !scene.weights_before && !scene.polygons_before) return surfaces.deformed;
  SceneInputs before = scene;
  before.joints = scene.joints_before, before.weights = scene.weights_before;
  return newest(frame.add(Deform{}, {before, scene.polygons_before}, "before").deformed, scene.polygons_before);
}
}  // namespace

void describe(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
              const OcclusionTexels& occlusion) {
  Layers::In wanted{scene, surfaces.draws, surfaces.deformed, lighting.unoccluded()};
  for (uint32_t i = 0; i < layer_count; ++i) wanted.wanted[i] = frame.request.has_layer(Layers::layers[i].name);
  frame.add(Layers{}, wanted);
  Lighting shadows = lighting.unoccluded();
  shadows.voxels = lighting.voxels;
  frame.add(SunLayers{}, {scene, surfaces.draws, surfaces.deformed, shadows});
  frame.add(LocalLayers{}, {scene, surfaces.draws, surfaces.deformed, shadows});
  frame.add(OcclusionLayer{}, {scene, surfaces.draws, surfaces.deformed, occlusion, lighting.rays});
  frame.add(MotionLayer{}, {scene, surfaces.draws, surfaces.deformed, deformed_before(frame, scene, surfaces)});
  frame.add(LightHeat{}, {scene, surfaces.draws, surfaces.deformed, lighting.unoccluded()});
  LightVolumes volumes;
  if (LightVolumeLayer{}.needed(frame.facts, frame.request))
    volumes = frame.add(LightVolumeLists{}, {scene, true}, "layer").volumes;
  frame.add(LightVolumeLayer{}, {scene, volumes});
  frame.add(TraversalHeat{}, {scene});
  frame.add(TreeBoxes{}, {scene});
}

}  // namespace candela
