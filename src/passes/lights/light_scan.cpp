#include "passes/lights/light_scan.h"

#include "shared/lights.h"

namespace candela {

Need LightScan::needed(const SceneFacts&, const FrameRequest&) const {
  return needed_if(grid.compact, grid.reason.empty() ? "the light lists are bitmasks" : grid.reason);
}

LightScan::Out LightScan::declare(GraphBuilder& builder, const In& in) const {
  Out out;
  if (grid.segments) {
    out.merge = builder.pipeline(ComputePipelineDesc{"light_rows.comp", {}});
    const uint64_t groups = grid.cells / shared::light_scan_cells + 1;
    builder.begin_step();
    builder.read(in.counts, Access::compute_read, "counts of lights");
    out.rows = builder.write(in.counts, Access::compute_write);
    out.totals =
        builder.write(builder.create(BufferDesc{"light.totals", uint64_t(grid.cells) * 4}), Access::compute_write);
    out.sums = builder.write(builder.create(BufferDesc{.name = "light.sums", .size_bytes = groups * 4, .zeroed = true}),
                             Access::compute_write);
    builder.begin_step();
  }
  builder.read(grid.segments ? out.totals : in.counts, Access::compute_read, "counts of lights");
  builder.read(grid.segments ? out.sums : in.sums, Access::compute_read, "counts of lights");
  out.offsets =
      builder.write(builder.create(BufferDesc{"light.offsets", (uint64_t(grid.cells) + 1) * 4}), Access::compute_write);
  out.pipeline = builder.pipeline(ComputePipelineDesc{"light_scan.comp", {}});
  return out;
}

void LightScan::record(CommandList& commands, const In& in, const Out& out) const {
  if (grid.segments && commands.step() == 0) {
    commands.bind(out.merge);
    shared::LightRowsPush push{};
    push.rows = commands.address(out.rows);
    push.counts = commands.address(out.totals);
    push.sums = commands.address(out.sums);
    push.cells = grid.cells;
    commands.push(push);
    commands.dispatch(grid.cells);
    return;
  }
  commands.bind(out.pipeline);
  shared::LightScanPush push{};
  push.counts = commands.address(grid.segments ? out.totals : in.counts);
  push.sums = commands.address(grid.segments ? out.sums : in.sums);
  push.offsets = commands.address(out.offsets);
  push.cells = grid.cells;
  commands.push(push);
  commands.dispatch(grid.cells);
}

}  // namespace candela
