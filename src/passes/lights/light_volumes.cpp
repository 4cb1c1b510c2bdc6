#include "passes/lights/light_volumes.h"

#include "shared/light_volumes.h"

namespace candela {
namespace {
uint32_t groups_of(const SceneInputs& scene) {
  return (scene.light_room + shared::light_volumes_group - 1) / shared::light_volumes_group;
}
}  // namespace

Need LightVolumeLists::needed(const SceneFacts& facts, const FrameRequest&) const {
  if (facts.lit_items == 0) return {false, "the scene has no opaque or masked surface that takes light"};
  return needed_if(facts.lights() > 0, "the scene has no light");
}

LightVolumeLists::Out LightVolumeLists::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  builder.read(s.lights, Access::compute_read, "lights");
  const uint64_t groups = groups_of(s), lists = shared::volume_lists;
  Out out;
  out.masks = builder.create(BufferDesc{"light_volumes.masks", groups * lists * shared::light_volumes_group / 8});
  out.counts = builder.create(BufferDesc{"light_volumes.counts", groups * lists * 4});
  BufferDesc all{"light_volumes.lists", lists * uint64_t(s.light_room) * 4};
  all.zeroed = true;  // a list need not be full
  out.volumes.lists = builder.create(all);
  out.volumes.draws = builder.create(BufferDesc{"light_volumes.draws", sizeof(shared::VolumeDraws)});
  const std::string defined = in.ordered ? "#ORDERED=1" : "";
  out.cull = builder.pipeline(ComputePipelineDesc{"light_volumes_cull.comp" + defined, {}});
  out.list = builder.pipeline(ComputePipelineDesc{"light_volumes_list.comp" + defined, {}});
  builder.begin_step();
  out.masks = builder.write(out.masks, Access::compute_write);
  out.counts = builder.write(out.counts, Access::compute_write);
  builder.begin_step();
  builder.read(out.masks, Access::compute_read, "which lights are seen");
  builder.read(out.counts, Access::compute_read, "how many these are");
  out.volumes.lists = builder.write(out.volumes.lists, Access::compute_write);
  out.volumes.draws = builder.write(out.volumes.draws, Access::compute_write);
  return out;
}

void LightVolumeLists::record(CommandList& commands, const In& in, const Out& out) const {
  shared::LightVolumesPush push{};
  push.lights = commands.address(in.scene.lights);
  push.masks = commands.address(out.masks);
  push.counts = commands.address(out.counts);
  if (commands.step() == 1) {
    push.lists = commands.address(out.volumes.lists);
    push.draws = commands.address(out.volumes.draws);
  }
  push.group_count = groups_of(in.scene);
  commands.bind(commands.step() == 0 ? out.cull : out.list);
  commands.push(push);
  commands.dispatch(push.group_count * shared::light_volumes_group);
}

}  // namespace candela
