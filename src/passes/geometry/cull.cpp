#include "passes/geometry/cull.h"

#include "shared/cull.h"

namespace candela {

std::span<const Knob> CullKnobs::table() {
  static const Knob table[] = {
      {.name = "enabled",
       .member = &CullKnobs::enabled,
       .lowest = 0,
       .highest = 1,
       .levels = {1},
       .description = "0 draws everything; changes time, never the image",
       .kind = Trades::time,
       .sweep = {0, 1}},
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
  ComputePipelineDesc pipeline{"cull.comp", {}};
  if (!in.views.is_camera()) {
    for (const BufferHandle b : {in.views.table, in.views.regions}) builder.read(b, Access::compute_read, "the views");
    builder.read_optional(in.scene.materials, Access::compute_read);  // what glows casts no shadow of a lamp
    pipeline.constants = {{0, "HAS_VIEW_TABLE", 1}};
    if (in.views.moving) {
      builder.read(in.views.moving, Access::compute_read, "what moves");
      pipeline.constants.push_back({1, "TELLS_MOVING", 1});
    }
  }
  const uint64_t groups = uint64_t(in.scene.cull_group_count) * in.views.room();
  Out out;
  out.masks = builder.create(BufferDesc{"cull.masks", groups * shared::cull_mask_words * sizeof(uint32_t)});
  out.masks = builder.write(out.masks, Access::compute_write);
  out.survivors = builder.create(BufferDesc{"cull.survivors", groups * sizeof(uint32_t)});
  out.survivors = builder.write(out.survivors, Access::compute_write);
  out.pipeline = builder.pipeline(pipeline);
  return out;
}

void Cull::record(CommandList& commands, const In& in, const Out& out) const {
  if (in.views.drawn() == 0) return;
  commands.bind(out.pipeline);
  shared::CullPush push{};
  push.groups = commands.address(in.scene.cull_groups);
  push.masks = commands.address(out.masks);
  push.survivors = commands.address(out.survivors);
  if (!in.views.is_camera()) {
    push.views = commands.address(in.views.table) + in.views.first * sizeof(shared::View);
    push.regions = commands.address(in.views.regions);
    if (in.views.moving) push.moving = commands.address(in.views.moving);
  }
  push.group_count = in.scene.cull_group_count;
  push.run_count = uint32_t(in.scene.draw_batches->size());
  push.view_count = in.views.drawn();
  push.culling = uint32_t(knobs.enabled);
  commands.push(push);
  const glm::uvec2 threads = shared::cull_threads(in.scene.cull_group_count * in.views.drawn());
  commands.dispatch(threads.x, threads.y);
}

}  // namespace candela
