#include "passes/lights/light_scan.h"

#include "shared/lights.h"

namespace candela {

Need LightScan::needed(const SceneFacts&, const FrameRequest&) const {
  return needed_if(grid.compact, grid.reason.empty() ? "the light lists are bitmasks" : grid.reason);
}

LightScan::Out LightScan::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.counts, Access::compute_read, "counts of lights");
  builder.read(in.sums, Access::compute_read, "counts of lights");
  Out out;
  out.offsets =
      builder.write(builder.create(BufferDesc{"light.offsets", (uint64_t(grid.cells) + 1) * 4}), Access::compute_write);
  out.pipeline = builder.pipeline(ComputePipelineDesc{"light_scan.comp", {}});
  return out;
}

void LightScan::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::LightScanPush push{};
  push.counts = commands.address(in.counts);
  push.sums = commands.address(in.sums);
  push.offsets = commands.address(out.offsets);
  push.cells = grid.cells;
  commands.push(push);
  commands.dispatch(grid.cells);
}

}  // namespace candela
