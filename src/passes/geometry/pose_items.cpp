#include "passes/geometry/pose_items.h"

#include "shared/pose_items.h"

namespace candela {

std::span<const Knob> PoseItems::Knobs::table() {
  static const Knob table[] = {
      {.name = "enabled",
       .member = &Knobs::enabled,
       .lowest = 0,
       .highest = 1,
       .levels = {1},
       .description = "pose instances of meshes on the device; 0: on the host",
       .kind = Trades::time,
       .sweep = {0, 1}},
  };
  return table;
}

Need PoseItems::needed(const SceneFacts&, const FrameRequest&) const {
  return needed_if(on_device, "the host poses all items, and no pass changes them");
}

PoseItems::Out PoseItems::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  for (const BufferHandle b : {s.item_groups, s.item_spans}) builder.read(b, Access::compute_read, "groups of items");
  for (const BufferHandle b : {s.item_sections, s.mesh_instances, s.posed_transforms, s.posed_items, s.batch_spans,
                               s.posed_batches, s.posed_places})
    builder.read_optional(b, Access::compute_read);
  Out out;
  out.transforms = builder.write(s.transforms, Access::compute_write);
  out.items = builder.write(s.items, Access::compute_write);
  if (s.places) out.places = builder.write(s.places, Access::compute_write);
  out.pose_transforms = builder.pipeline(ComputePipelineDesc{"pose_items_transforms.comp", {}});
  out.pose_items = builder.pipeline(ComputePipelineDesc{"pose_items.comp", {}});
  if (s.batch_count == 0) return out;
  out.batches = builder.write(s.batches, Access::compute_write);
  out.pose_batches = builder.pipeline(ComputePipelineDesc{"pose_items_batches.comp", {}});
  return out;
}

void PoseItems::record(CommandList& commands, const In& in, const Out& out) const {
  const SceneInputs& s = in.scene;
  shared::PoseItemsPush push{};
  // Never read where there is nothing; the addresses must be valid.
  const auto address = [&](BufferHandle buffer) { return commands.address(buffer ? buffer : s.item_groups); };
  push.groups = address(s.item_groups), push.spans = address(s.item_spans);
  push.sections = address(s.item_sections), push.instances = address(s.mesh_instances);
  push.batch_spans = address(s.batch_spans);
  push.posed_transforms = address(s.posed_transforms), push.posed_items = address(s.posed_items);
  push.posed_batches = address(s.posed_batches);
  push.transforms = address(out.transforms), push.items = address(out.items), push.batches = address(out.batches);
  push.posed_places = address(s.posed_places);
  push.places = out.places ? commands.address(out.places) : 0;
  push.transform_count = s.transform_count, push.item_count = s.item_count, push.batch_count = s.batch_count;
  push.group_count = s.item_group_count, push.span_count = s.item_span_count;
  push.batch_span_count = s.batch_span_count;
  const auto pose = [&](PipelineHandle pipeline, uint32_t count) {
    commands.bind(pipeline);
    commands.push(push);
    const glm::uvec2 threads = shared::light_threads(count);
    commands.dispatch(threads.x, threads.y);
  };
  pose(out.pose_transforms, s.transform_count);
  pose(out.pose_items, s.item_count);
  if (s.batch_count > 0) pose(out.pose_batches, s.batch_count);
}

}  // namespace candela
