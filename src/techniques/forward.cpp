#include "techniques/forward.h"

#include "passes/clear.h"
#include "passes/cull.h"
#include "passes/cull_compact.h"
#include "passes/deform.h"
#include "passes/depth_prepass.h"
#include "passes/light_assign.h"
#include "passes/light_fill.h"
#include "passes/light_scan.h"
#include "passes/light_sort.h"
#include "passes/shade_forward.h"
#include "passes/shade_unlit.h"
#include "passes/sky.h"
#include "passes/transparent.h"

namespace candela {
namespace {
// A pass that draws over an image gives it a new version; one that was left out leaves the old.
ImageHandle newest(ImageHandle made, ImageHandle before) { return made ? made : before; }
}  // namespace

ForwardGeometry forward_geometry(Frame& frame, const SceneInputs& scene, const FrameKnobs& knobs) {
  ForwardGeometry g;
  Cull cull;
  cull.knobs.enabled = knobs.cull_enabled ? 1 : 0;
  const BufferHandle survivors = frame.add(cull, {scene}).survivors;
  g.draws = frame.add(CullCompact{}, {scene, survivors, knobs.cull_enabled}).draws;
  g.deformed = frame.add(Deform{}, {scene}).deformed;
  g.depth = frame.add(DepthPrepass{}, {scene, g.draws, g.deformed}).depth;
  return g;
}

CellLists make_light_lists(Frame& frame, const SceneInputs& scene, BufferHandle tiles) {
  const LightGridShape& grid = scene.light_grid;
  const LightAssign::Out assigned = frame.add(LightAssign{grid}, {scene, tiles});
  const BufferHandle offsets = frame.add(LightScan{grid}, {assigned.lists, assigned.sums}).offsets;
  const BufferHandle unsorted = frame.add(LightFill{grid}, {scene, offsets, assigned.hits}).unsorted;
  const BufferHandle entries = frame.add(LightSort{grid}, {offsets, unsorted}).entries;
  return {grid.compact ? offsets : assigned.lists, entries, tiles};
}

FrameImages forward_shading(Frame& frame, const SceneInputs& scene, const ForwardGeometry& g, const CellLists& lists) {
  ImageHandle color = frame.add(Clear{}, {scene}).color;
  color = newest(frame.add(ShadeForward{}, {scene, g.draws, g.deformed, lists, g.depth, color}).color, color);
  color = newest(frame.add(ShadeUnlit{}, {scene, g.draws, g.deformed, g.depth, color}).color, color);
  color = newest(frame.add(Sky{}, {scene, g.depth, color}).color, color);
  color = newest(frame.add(Transparent{}, {scene, g.draws, g.deformed, lists, g.depth, color}).color, color);

  Layers::In wanted{scene, g.draws, g.deformed, lists};
  for (uint32_t i = 0; i < layer_count; ++i) wanted.wanted[i] = frame.request.has_layer(layer_name_table()[i]);
  return {color, frame.add(Layers{}, wanted).images};
}

}  // namespace candela
