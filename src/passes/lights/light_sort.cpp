#include "passes/lights/light_sort.h"

#include "shared/lights.h"

namespace candela {

Need LightSort::needed(const SceneFacts&, const FrameRequest&) const {
  if (grid.segments) return {false, "light_fill writes lists in light order (lights.order)"};
  return needed_if(grid.compact, grid.reason.empty() ? "the light lists are bitmasks" : grid.reason);
}

std::vector<std::string> LightSort::warnings(const Report& report) const {
  if (report.lost == 0) return {};
  return {fmt::format(
      "lights.cap={}: {} lights of {} cells are LOST (the longest list has {}); the picture lacks their light",
      grid.knobs.cap, report.lost, report.cells, report.longest)};
}

LightSort::Out LightSort::declare(GraphBuilder& builder, const In& in) const {
  Out out;
  out.entries = builder.create(BufferDesc{"light.entries", grid.most_entries * 4});
  ComputePipelineDesc desc{"light_sort.comp", {}};
  if (grid.knobs.cap > 0) {
    desc.constants.push_back({0, "CAPPED", 1});
    out.report = builder.create(BufferDesc{"light.lost", sizeof(Report), BufferMemory::host_read, true});
  }
  out.rank = builder.pipeline(ComputePipelineDesc{"light_rank.comp", {}});
  out.sort = builder.pipeline(desc);
  builder.read(in.offsets, Access::compute_read, "where lists begin");
  builder.read(in.unsorted, Access::compute_read, "lights of cells");
  // Both write, no list twice.
  out.entries = builder.write(out.entries, Access::compute_write);
  if (out.report) {
    out.report = builder.write(out.report, Access::compute_write);
    builder.sink(out.report);
  }
  return out;
}

void LightSort::record(CommandList& commands, const In& in, const Out& out) const {
  shared::LightSortPush push{};
  push.offsets = commands.address(in.offsets);
  push.unsorted = commands.address(in.unsorted);
  push.entries = commands.address(out.entries);
  push.report = out.report ? commands.address(out.report) : 0;
  push.cells = grid.cells;
  push.cap = uint32_t(grid.knobs.cap);
  commands.bind(out.rank);
  commands.push(push);
  const glm::uvec2 threads = shared::light_threads(grid.most_entries);
  commands.dispatch(threads.x, threads.y);
  commands.bind(out.sort);
  commands.push(push);
  const uint32_t groups = (grid.cells + shared::light_sort_cells - 1) / shared::light_sort_cells;
  commands.dispatch(groups * shared::light_sort_threads);
}

}  // namespace candela
