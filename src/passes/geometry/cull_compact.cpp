#include "passes/geometry/cull_compact.h"

#include <algorithm>
#include <bit>

#include "shared/cull.h"

namespace candela {

Need CullCompact::needed(const SceneFacts& facts, const FrameRequest&) const {
  return needed_if(facts.draw_items > 0, "the scene draws nothing");
}

CullCompact::Out CullCompact::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {in.scene.items, in.scene.cull_groups})
    builder.read(b, Access::compute_read, "the scene");
  builder.read(in.masks, Access::compute_read, "the items that stay");
  builder.read(in.survivors, Access::compute_read, "survivor counts");
  ComputePipelineDesc pipeline{"cull_compact.comp", {}};
  uint64_t room = in.scene.item_count;
  if (!in.views.is_camera()) {
    builder.read(in.views.regions, Access::compute_read, "the views");
    pipeline.constants = {{0, "HAS_VIEW_TABLE", 1}};
    // In powers of two: views that move do not change the plan.
    room = std::bit_ceil(std::max<uint64_t>({in.views.first_command->back(), in.views.commands, 1}));
  }
  Out out;
  out.draws.first_command = in.views.first_command;
  out.draws.commands = builder.create(BufferDesc{"cull.commands", room * sizeof(shared::DrawCommand)});
  out.draws.commands = builder.write(out.draws.commands, Access::compute_write);
  out.draws.counts =
      builder.create(BufferDesc{"cull.counts", in.scene.draw_batches->size() * in.views.room() * sizeof(uint32_t)});
  out.draws.counts = builder.write(out.draws.counts, Access::compute_write);
  out.pipeline = builder.pipeline(pipeline);
  return out;
}

void CullCompact::record(CommandList& commands, const In& in, const Out& out) const {
  if (in.views.drawn() == 0) return;
  commands.bind(out.pipeline);
  shared::CullPush push{};
  push.groups = commands.address(in.scene.cull_groups);
  push.masks = commands.address(in.masks);
  push.survivors = commands.address(in.survivors);
  push.commands = commands.address(out.draws.commands);
  push.counts = commands.address(out.draws.counts);
  if (!in.views.is_camera()) push.regions = commands.address(in.views.regions);
  push.group_count = in.scene.cull_group_count;
  push.run_count = uint32_t(in.scene.draw_batches->size());
  push.view_count = in.views.drawn();
  commands.push(push);
  const glm::uvec2 threads = shared::cull_threads(in.scene.cull_group_count * in.views.drawn());
  commands.dispatch(threads.x, threads.y);
}

}  // namespace candela
