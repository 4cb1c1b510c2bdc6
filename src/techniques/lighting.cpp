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

Lighting light_surfaces(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, std::string_view instance) {
  return {light_lists(frame, scene, surfaces.depth, instance)};
}

}  // namespace candela
