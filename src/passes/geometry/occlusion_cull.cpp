#include "passes/geometry/occlusion_cull.h"

#include "shared/cull.h"

namespace candela {

namespace {
BufferHandle create_masks(GraphBuilder& builder, const SceneInputs& scene, const char* masks) {
  const uint64_t words = uint64_t(scene.cull_group_count) * shared::cull_mask_words;
  return builder.write(builder.create(BufferDesc{masks, words * sizeof(uint32_t)}), Access::compute_write);
}
BufferHandle create_survivors(GraphBuilder& builder, const SceneInputs& scene, const char* survivors) {
  return builder.write(builder.create(BufferDesc{survivors, scene.cull_group_count * sizeof(uint32_t)}),
                       Access::compute_write);
}
void read_items(GraphBuilder& builder, const SceneInputs& scene) {
  builder.read(scene.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {scene.items, scene.cull_groups}) builder.read(b, Access::compute_read, "the scene");
}
void dispatch_groups(CommandList& commands, const SceneInputs& scene) {
  const glm::uvec2 threads = shared::cull_threads(scene.cull_group_count);
  commands.dispatch(threads.x, threads.y);
}
}  // namespace

Occluders::Out Occluders::declare(GraphBuilder& builder, const In& in) const {
  read_items(builder, in.scene);
  builder.read(in.kept, Access::compute_read, "the items in view");
  Out out;
  out.masks = create_masks(builder, in.scene, "occluders.masks");
  out.survivors = create_survivors(builder, in.scene, "occluders.survivors");
  out.pipeline = builder.pipeline(ComputePipelineDesc{"occluders.comp", {}});
  return out;
}

void Occluders::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::OccludersPush push{};
  push.groups = commands.address(in.scene.cull_groups);
  push.kept = commands.address(in.kept);
  push.masks = commands.address(out.masks);
  push.survivors = commands.address(out.survivors);
  push.subsample_ndc = in.scene.subsample_ndc();
  push.first_phase_px = knobs.first_fraction * float(in.scene.width_px) * float(in.scene.height_px);
  push.group_count = in.scene.cull_group_count;
  commands.push(push);
  dispatch_groups(commands, in.scene);
}

OcclusionCull::Out OcclusionCull::declare(GraphBuilder& builder, const In& in) const {
  read_items(builder, in.scene);
  builder.read(in.kept, Access::compute_read, "the items in view");
  builder.read(in.occluders, Access::compute_read, "the items that are drawn first");
  builder.read(in.pyramid, Access::sampled_compute, "the depth pyramid");
  Out out;
  out.visible = create_masks(builder, in.scene, "occlusion_cull.visible");
  out.visible_survivors = create_survivors(builder, in.scene, "occlusion_cull.visible_survivors");
  out.rest = create_masks(builder, in.scene, "occlusion_cull.rest");
  out.rest_survivors = create_survivors(builder, in.scene, "occlusion_cull.rest_survivors");
  if (in.reports) {
    const BufferDesc report{"occlusion_cull.report", sizeof(Report), BufferMemory::host_read, true};
    out.report = builder.write(builder.create(report), Access::compute_write);
    builder.sink(out.report);
  }
  out.pipeline = builder.pipeline(ComputePipelineDesc{"occlusion_cull.comp", {}});
  return out;
}

void OcclusionCull::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::OcclusionCullPush push{};
  push.groups = commands.address(in.scene.cull_groups);
  push.kept = commands.address(in.kept);
  push.occluders = commands.address(in.occluders);
  push.visible = commands.address(out.visible);
  push.visible_survivors = commands.address(out.visible_survivors);
  push.rest = commands.address(out.rest);
  push.rest_survivors = commands.address(out.rest_survivors);
  push.report = out.report ? commands.address(out.report) : 0;
  push.subsample_ndc = in.scene.subsample_ndc();
  push.pyramid = commands.sampled(in.pyramid);
  push.group_count = in.scene.cull_group_count;
  commands.push(push);
  dispatch_groups(commands, in.scene);
}

std::vector<std::string> OcclusionCull::notes(const Report& report) const {
  return {fmt::format("occlusion culling: of {} items in view {} are drawn first, {} after, and {} are hidden",
                      report.kept, report.occluders, report.rest, report.hidden)};
}

}  // namespace candela
