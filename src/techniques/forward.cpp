#include "passes/debug/layers.h"
#include "passes/debug/light_heat.h"
#include "passes/geometry/cull.h"
#include "passes/geometry/cull_compact.h"
#include "passes/geometry/deform.h"
#include "passes/geometry/depth_prepass.h"
#include "passes/lights/light_assign.h"
#include "passes/lights/light_fill.h"
#include "passes/lights/light_scan.h"
#include "passes/lights/light_sort.h"
#include "passes/lights/tile_depth.h"
#include "passes/sky/background.h"
#include "passes/sky/sky.h"
#include "passes/surfaces/shade_forward.h"
#include "passes/surfaces/shade_unlit.h"
#include "passes/surfaces/transparent.h"
#include "techniques/technique.h"

namespace candela {
namespace {

// A pass that draws over an image gives it a new version; one that was left out leaves the old.
ImageHandle newest(ImageHandle made, ImageHandle before) { return made ? made : before; }

CellLists make_light_lists(Frame& frame, const SceneInputs& scene, ImageHandle depth) {
  const LightGridShape& grid = scene.light_grid;
  const BufferHandle tiles = frame.add(TileDepth{grid}, {scene, depth}).tiles;
  const LightAssign::Out assigned = frame.add(LightAssign{grid}, {scene, tiles});
  const BufferHandle offsets = frame.add(LightScan{grid}, {assigned.lists, assigned.sums}).offsets;
  const BufferHandle unsorted = frame.add(LightFill{grid}, {scene, offsets, assigned.hits}).unsorted;
  const BufferHandle entries = frame.add(LightSort{grid}, {offsets, unsorted}).entries;
  return {grid.compact ? offsets : assigned.lists, entries, tiles};
}

}  // namespace

// Forward shading after a depth pre-pass. The techniques that it serves differ in nothing but the light grid of the
// scene's inputs: clusters (Olsson, Billeter, Assarsson, "Clustered Deferred and Forward Shading", 2012), where a point
// takes the list of its own depth; tiles between the depths of their samples (Harada, McKee, Yang, "Forward+: Bringing
// Deferred Lighting to the Next Level", 2012), where a point outside them takes the list of its column; or none, where
// every pixel walks every light.
FrameImages forward(Frame& frame, const SceneInputs& scene, const FrameKnobs& knobs) {
  Cull cull;
  cull.knobs.enabled = knobs.cull_enabled ? 1 : 0;
  const Cull::Out culled = frame.add(cull, {scene});
  const Draws draws = frame.add(CullCompact{}, {scene, culled.masks, culled.survivors}).draws;
  const BufferHandle deformed = frame.add(Deform{}, {scene}).deformed;
  const ImageHandle depth = frame.add(DepthPrepass{}, {scene, draws, deformed}).depth;
  const CellLists lists = make_light_lists(frame, scene, depth);

  ImageHandle color = frame.add(ShadeForward{}, {scene, draws, deformed, lists, depth, {}}).color;
  color = newest(frame.add(ShadeUnlit{}, {scene, draws, deformed, depth, color}).color, color);
  color = newest(frame.add(Sky{}, {scene, depth, color}).color, color);
  color = newest(frame.add(Background{}, {scene, depth, color}).color, color);
  color = newest(frame.add(Transparent{}, {scene, draws, deformed, lists, depth, color}).color, color);

  FrameImages images{color, {}};
  Layers::In wanted{scene, draws, deformed, lists};
  for (uint32_t i = 0; i < layer_count; ++i) wanted.wanted[i] = frame.request.has_layer(layer_name_table()[i]);
  const auto layers = frame.add(Layers{}, wanted).images;
  for (uint32_t i = 0; i < layer_count; ++i)
    if (layers[i]) images.layers.emplace_back(layer_name_table()[i], layers[i]);
  const auto counts = frame.add(LightHeat{}, {scene, draws, deformed, lists}).counts;
  for (size_t i = 0; i < counts.size(); ++i)
    if (counts[i] && frame.request.has_layer(LightHeat::layers[i]))
      images.layers.emplace_back(LightHeat::layers[i], counts[i]);
  return images;
}

}  // namespace candela
