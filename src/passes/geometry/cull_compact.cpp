#include "passes/geometry/cull_compact.h"

#include "shared/cull.h"

namespace candela {

Need CullCompact::needed(const SceneFacts& facts, const FrameRequest&) const {
  return needed_if(facts.draw_items > 0, "the scene draws nothing");
}

CullCompact::Out CullCompact::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {in.scene.items, in.scene.cull_groups})
    builder.read(b, Access::compute_read, "the scene");
  builder.read(in.survivors, Access::compute_read, "survivor counts");
  Out out;
  out.draws.commands = builder.create(BufferDesc{"cull.commands", in.scene.item_count * sizeof(shared::DrawCommand)});
  out.draws.commands = builder.write(out.draws.commands, Access::compute_write);
  out.draws.counts = builder.create(BufferDesc{"cull.counts", in.scene.runs->size() * sizeof(uint32_t)});
  out.draws.counts = builder.write(out.draws.counts, Access::compute_write);
  out.pipeline = builder.pipeline(ComputePipelineDesc{"cull_compact.comp", {}});
  return out;
}

void CullCompact::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::CullPush push{};
  push.groups = commands.address(in.scene.cull_groups);
  push.survivors = commands.address(in.survivors);
  push.commands = commands.address(out.draws.commands);
  push.counts = commands.address(out.draws.counts);
  push.culling = in.culling ? 1 : 0;
  push.group_count = in.scene.cull_group_count;
  commands.push(push);
  const glm::uvec2 threads = shared::cull_threads(in.scene.cull_group_count);
  commands.dispatch(threads.x, threads.y);
}

}  // namespace candela
