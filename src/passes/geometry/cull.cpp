#include "passes/geometry/cull.h"

#include "shared/cull.h"

namespace candela {

std::span<const Knob<Cull::Knobs>> Cull::Knobs::table() {
  static const Knob<Knobs> table[] = {
      {"enabled",
       &Knobs::enabled,
       "",
       0,
       1,
       {1},
       "0 draws everything; changes time, never the image",
       {},
       Trades::time,
       {0, 1},
       {"cull", "cull_compact", "depth_prepass", "shade_forward", "shade_unlit"}},
  };
  return table;
}

Need Cull::needed(const SceneFacts& facts, const FrameRequest&) const {
  return needed_if(facts.draw_items > 0, "the scene draws nothing");
}

Cull::Out Cull::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {in.scene.items, in.scene.cull_groups})
    builder.read(b, Access::compute_read, "the scene");
  Out out;
  out.survivors = builder.create(BufferDesc{"cull.survivors", in.scene.cull_group_count * sizeof(uint32_t)});
  out.survivors = builder.write(out.survivors, Access::compute_write);
  out.pipeline = builder.pipeline(ComputePipelineDesc{"cull.comp", {}});
  return out;
}

void Cull::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::CullPush push{};
  push.groups = commands.address(in.scene.cull_groups);
  push.survivors = commands.address(out.survivors);
  push.culling = uint32_t(knobs.enabled);
  push.group_count = in.scene.cull_group_count;
  commands.push(push);
  const glm::uvec2 threads = shared::cull_threads(in.scene.cull_group_count);
  commands.dispatch(threads.x, threads.y);
}

}  // namespace candela
