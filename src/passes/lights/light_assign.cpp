#include "passes/lights/light_assign.h"

#include "passes/lights/light_segments.h"
#include "shared/lights.h"

namespace candela {

Need LightAssign::needed(const SceneFacts&, const FrameRequest&) const {
  return needed_if(grid.reason.empty(), grid.reason);
}

bool LightAssign::ignores(std::string_view knob) const {
  if (knob == "order") return !grid.compact;
  return grid.tiled ? knob == "tile_px" || knob == "slices_per_octave" : knob == "mask";
}

LightAssign::Out LightAssign::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {in.boxes.bounds, in.boxes.chunks, in.boxes.dispatch})
    builder.read(b, Access::compute_read, "the lights' cells");
  builder.read(in.boxes.dispatch, Access::indirect_read, "how many these are");
  if (grid.tiled) builder.read(in.tiles, Access::compute_read, "tile depths");
  const auto zeroed = [&](const char* buffer, uint64_t words) {
    return builder.write(builder.create(BufferDesc{.name = buffer, .size_bytes = words * 4, .zeroed = true}),
                         Access::compute_write);
  };
  Out out;
  const uint64_t rows = grid.segments ? shared::light_segments : 1;
  if (grid.compact) {
    out.lists = zeroed("light.counts", rows * grid.cells);
    if (!grid.segments) out.sums = zeroed("light.sums", grid.cells / shared::light_scan_cells + 1);
    const uint64_t hit_words = grid.most_chunks * uint64_t(shared::light_chunk_cells) / 32;
    BufferDesc hits{"light.hits", (hit_words + shared::light_chunk_cells) * 4};
    hits.zeroed = true;
    hits.unordered = grid.most_bounds > 0;  // as its chunks
    out.hits = builder.write(builder.create(hits), Access::compute_write);
  } else {
    out.lists = zeroed("light.masks", uint64_t(grid.cells) * grid.words);
  }
  ComputePipelineDesc desc{grid.segments ? "light_assign_segments.comp" : "light_assign.comp",
                           {{0, "TEST", uint32_t(grid.knobs.test)}}};
  if (grid.compact && !grid.segments) desc.constants.push_back({1, "COMPACT", 1});
  if (grid.tiled) desc.constants.push_back({2, "TILED", 1});
  if (grid.tiled && grid.knobs.mask) desc.constants.push_back({3, "MASK", 1});
  out.pipeline = builder.pipeline(desc);
  return out;
}

void LightAssign::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  if (grid.segments) {
    shared::LightSegmentsPush push{};
    push.tiles = grid.tiled ? commands.address(in.tiles) : 0;
    push.rows = commands.address(out.lists);
    push.hits = commands.address(out.hits);
    return dispatch_segments(commands, grid, in.boxes, push);
  }
  shared::LightAssignPush push{};
  push.bounds = commands.address(in.boxes.bounds);
  push.chunks = commands.address(in.boxes.chunks);
  push.dispatch = commands.address(in.boxes.dispatch);
  push.tiles = grid.tiled ? commands.address(in.tiles) : 0;
  push.lists = commands.address(out.lists);
  push.sums = grid.compact ? commands.address(out.sums) : 0;
  push.hits = grid.compact ? commands.address(out.hits) : 0;
  commands.push(push);
  commands.dispatch_indirect(in.boxes.dispatch, offsetof(shared::LightDispatch, groups));
}

}  // namespace candela
