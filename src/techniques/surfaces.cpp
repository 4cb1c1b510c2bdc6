#include "passes/geometry/draw_runs.h"
#include "techniques/technique.h"

namespace candela {

namespace {

// Depths of the surfaces, and, where compute rasterizes triangles, which are seen.
void find_nearest(Frame& frame, const SceneInputs& scene, Surfaces& surfaces, std::string_view instance = {}) {
  surfaces.keys = {}, surfaces.depth = {};
  const auto leave_out = [&](std::string_view pass, std::string_view reason) {
    if (is_first_picture(instance)) frame.builder.leave_out(std::string(pass), std::string(reason));
  };
  if (scene.batch_count == 0) {
    for (const std::string_view pass : {Rasterize::name, TraceKeys::name, KeyDepth::name})
      leave_out(pass, "the hardware draws what the camera sees (--technique visibility, hybrid, ray)");
  } else {
    if (scene.triangle_numbers)
      leave_out(Rasterize::name, "rays find what the camera sees (trace_keys)");
    else
      leave_out(TraceKeys::name, "triangles are rasterized in compute (rasterize)");
    const bool by_sample = frame.knobs.get<DepthPrepass::Knobs>().by_sample != 0;
    surfaces.keys =
        scene.triangle_numbers
            ? frame.add(TraceKeys{}, {scene}, instance).keys
            : frame.add(Rasterize{}, {scene, surfaces.kept_items, surfaces.deformed, by_sample}, instance).keys;
    surfaces.depth =
        frame.add(KeyDepth{}, {surfaces.keys, scene.width_px, scene.height_px, scene.samples}, instance).depth;
    if (!draws_lines(scene)) {
      frame.builder.leave_out(std::string(DepthPrepass::name), "keys of triangles tell depths (rasterize, trace_keys)");
      surfaces.looked_up = {{}, surfaces.keys};
      return;
    }
  }
  surfaces.depth =
      frame.add(DepthPrepass{}, {scene, surfaces.draws, surfaces.deformed, surfaces.depth}, instance).depth;
  surfaces.looked_up = {surfaces.depth, {}};
}

}  // namespace

Surfaces visible_surfaces(Frame& frame, const SceneInputs& scene) {
  const Cull::Out culled = frame.add(Cull{}, {scene});
  Surfaces surfaces;
  surfaces.kept_items = culled.masks;
  surfaces.draws = frame.add(CullCompact{}, {scene, culled.masks, culled.survivors}).draws;
  surfaces.deformed = frame.add(Deform{}, {scene}).deformed;
  find_nearest(frame, scene, surfaces);
  return surfaces;
}

Surfaces seen_again(Frame& frame, const SceneInputs& scene, Surfaces surfaces, std::string_view instance) {
  find_nearest(frame, scene, surfaces, instance);
  return surfaces;
}

namespace {
// Deformed vertices of the time before; this one's where they are the same.
BufferHandle deformed_before(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces) {
  if (!scene.joints_before && !scene.weights_before) return surfaces.deformed;
  SceneInputs before = scene;
  before.joints = scene.joints_before, before.weights = scene.weights_before;
  return frame.add(Deform{}, {before}, "before").deformed;
}
}  // namespace

void describe(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
              const OcclusionTexels& occlusion) {
  Layers::In wanted{scene, surfaces.draws, surfaces.deformed, lighting.lists};
  for (uint32_t i = 0; i < layer_count; ++i) wanted.wanted[i] = frame.request.has_layer(Layers::layers[i].name);
  frame.add(Layers{}, wanted);
  frame.add(SunLayers{}, {scene, surfaces.draws, surfaces.deformed, lighting.lists});
  frame.add(LampLayers{}, {scene, surfaces.draws, surfaces.deformed, lighting.lists});
  frame.add(OcclusionLayer{}, {scene, surfaces.draws, surfaces.deformed, occlusion, lighting.lists.rays});
  frame.add(MotionLayer{}, {scene, surfaces.draws, surfaces.deformed, deformed_before(frame, scene, surfaces)});
  frame.add(LightHeat{}, {scene, surfaces.draws, surfaces.deformed, lighting.lists});
  LightVolumes volumes;
  if (LightVolumeLayer{}.needed(frame.facts, frame.request))
    volumes = frame.add(LightVolumeLists{}, {scene, true}, "layer").volumes;
  frame.add(LightVolumeLayer{}, {scene, volumes});
  frame.add(TraversalHeat{}, {scene});
  frame.add(TreeBoxes{}, {scene});
}

}  // namespace candela
