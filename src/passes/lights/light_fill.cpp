#include "passes/lights/light_fill.h"

#include "passes/lights/light_segments.h"
#include "shared/lights.h"

namespace candela {

Need LightFill::needed(const SceneFacts&, const FrameRequest&) const {
  return needed_if(grid.compact, grid.reason.empty() ? "the light lists are bitmasks" : grid.reason);
}

LightFill::Out LightFill::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {in.boxes.bounds, in.boxes.chunks, in.boxes.dispatch})
    builder.read(b, Access::compute_read, "the lights' cells");
  builder.read(in.boxes.dispatch, Access::indirect_read, "how many these are");
  builder.read(in.offsets, Access::compute_read, "where lists begin");
  builder.read(in.hits, Access::compute_read, "lights of cells");
  Out out;
  if (grid.segments) {
    builder.read(in.rows, Access::compute_read, "where segments begin in lists");
    out.entries =
        builder.write(builder.create(BufferDesc{"light.entries", grid.most_entries * 4}), Access::compute_write);
    out.cursors = builder.write(in.rows, Access::compute_write);
    out.pipeline = builder.pipeline(ComputePipelineDesc{"light_fill_segments.comp", {}});
    return out;
  }
  out.entries = builder.write(
      builder.create(BufferDesc{.name = "light.unsorted", .size_bytes = grid.most_entries * 4, .unordered = true}),
      Access::compute_write);
  out.cursors = builder.write(
      builder.create(BufferDesc{.name = "light.cursors", .size_bytes = uint64_t(grid.cells) * 4, .zeroed = true}),
      Access::compute_write);
  out.pipeline = builder.pipeline(ComputePipelineDesc{"light_fill.comp", {}});
  return out;
}

void LightFill::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  if (grid.segments) {
    shared::LightSegmentsPush push{};
    push.rows = commands.address(out.cursors);
    push.hits = commands.address(in.hits);
    push.offsets = commands.address(in.offsets);
    push.entries = commands.address(out.entries);
    return dispatch_segments(commands, grid, in.boxes, push);
  }
  shared::LightFillPush push{};
  push.bounds = commands.address(in.boxes.bounds);
  push.chunks = commands.address(in.boxes.chunks);
  push.dispatch = commands.address(in.boxes.dispatch);
  push.hits = commands.address(in.hits);
  push.offsets = commands.address(in.offsets);
  push.cursors = commands.address(out.cursors);
  push.entries = commands.address(out.entries);
  commands.push(push);
  commands.dispatch_indirect(in.boxes.dispatch, offsetof(shared::LightDispatch, groups));
}

}  // namespace candela
