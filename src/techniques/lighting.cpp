#include "techniques/technique.h"

namespace candela {
namespace {

CellLists light_lists(Frame& frame, const SceneInputs& scene, ImageHandle depth) {
  const LightGridShape& grid = scene.light_grid;
  const BufferHandle tiles = frame.add(TileDepth{grid}, {scene, depth}).tiles;
  const LightAssign::Out assigned = frame.add(LightAssign{grid}, {scene, tiles});
  const BufferHandle offsets = frame.add(LightScan{grid}, {assigned.lists, assigned.sums}).offsets;
  const BufferHandle unsorted = frame.add(LightFill{grid}, {scene, offsets, assigned.hits}).unsorted;
  const BufferHandle entries = frame.add(LightSort{grid}, {offsets, unsorted}).entries;
  return {grid.compact ? offsets : assigned.lists, entries, tiles};
}

}  // namespace

Lighting light_surfaces(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces) {
  return {light_lists(frame, scene, surfaces.depth)};
}

}  // namespace candela
