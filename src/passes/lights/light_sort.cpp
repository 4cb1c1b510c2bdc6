#include "passes/lights/light_sort.h"

#include "shared/lights.h"

namespace candela {

Need LightSort::needed(const SceneFacts&, const FrameRequest&) const {
  return needed_if(grid.compact, grid.reason.empty() ? "the light lists are bitmasks" : grid.reason);
}

std::vector<std::string> LightSort::warnings(const Report& report) const {
  if (report.lost == 0) return {};
  return {fmt::format(
      "lights.cap={}: {} lights of {} cells are LOST (the longest list has {}); the picture lacks their light",
      grid.knobs.cap, report.lost, report.cells, report.longest)};
}

LightSort::Out LightSort::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.offsets, Access::compute_read, "where lists begin");
  builder.read(in.unsorted, Access::compute_read, "lights of cells");
  Out out;
  out.entries =
      builder.write(builder.create(BufferDesc{"light.entries", grid.most_entries * 4}), Access::compute_write);
  ComputePipelineDesc desc{"light_sort.comp", {}};
  if (grid.knobs.cap > 0) {
    desc.constants.push_back({0, "CAPPED", 1});
    out.report = builder.write(builder.create(BufferDesc{"light.lost", sizeof(Report), BufferMemory::host_read, true}),
                               Access::compute_write);
    builder.sink(out.report);
  }
  out.pipeline = builder.pipeline(desc);
  return out;
}

void LightSort::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::LightSortPush push{};
  push.offsets = commands.address(in.offsets);
  push.unsorted = commands.address(in.unsorted);
  push.entries = commands.address(out.entries);
  push.report = out.report ? commands.address(out.report) : 0;
  push.cells = grid.cells;
  push.cap = uint32_t(grid.knobs.cap);
  commands.push(push);
  commands.dispatch(grid.cells);
}

}  // namespace candela
