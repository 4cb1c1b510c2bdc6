#include "passes/lights/tile_depth.h"

#include "shared/lights.h"

namespace candela {

Need TileDepth::needed(const SceneFacts&, const FrameRequest&) const {
  return needed_if(grid.tiled, grid.reason.empty() ? "clusters take a point's own depth" : grid.reason);
}

TileDepth::Out TileDepth::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  builder.read(in.depth, Access::sampled_compute, "depth");
  Out out;
  out.tiles = builder.create(
      BufferDesc{"light.tile_depths", uint64_t(grid.tiles_x) * grid.tiles_y * sizeof(shared::TileDepth)});
  out.tiles = builder.write(out.tiles, Access::compute_write);
  out.pipeline = builder.pipeline(ComputePipelineDesc{"tile_depth.comp", {{0, "SAMPLES", in.scene.samples}}});
  return out;
}

void TileDepth::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::TileDepthPush push{};
  push.tiles = commands.address(out.tiles);
  push.depth = commands.sampled(in.depth);
  commands.push(push);
  commands.dispatch(grid.tiles_x * tile_px, grid.tiles_y * tile_px);
}

}  // namespace candela
