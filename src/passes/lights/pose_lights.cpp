#include "passes/lights/pose_lights.h"

#include "shared/pose_lights.h"

namespace candela {

bool PoseLights::Knobs::on_device(bool is_cpu, uint32_t instances) const {
  return enabled == on || (enabled == automatic && !is_cpu && instances >= few);
}

std::span<const Knob> PoseLights::Knobs::table() {
  static const Knob table[] = {
      {.name = "enabled",
       .member = &Knobs::enabled,
       .lowest = off,
       .highest = automatic,
       .levels = {automatic},
       .description = "pose light instances on the device; off: on the host; auto: on a GPU, 2,048 or more",
       .choices = {"off", "on", "auto"},
       .kind = Trades::time,
       .sweep = {off, on, automatic}},
  };
  return table;
}

Need PoseLights::needed(const SceneFacts&, const FrameRequest&) const {
  return needed_if(on_device, "the host poses all lights");
}

PoseLights::Out PoseLights::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  builder.read(s.light_groups, Access::compute_read, "groups of lights");
  builder.read(s.light_instances, Access::compute_read, "light instances");
  builder.read_optional(s.posed_lights, Access::compute_read);
  Out out;
  out.lights = builder.create(BufferDesc{"lights", uint64_t(s.light_room) * sizeof(shared::Light)});
  out.lights = builder.write(out.lights, Access::compute_write);
  out.pipeline = builder.pipeline(ComputePipelineDesc{"pose_lights.comp", {}});
  return out;
}

void PoseLights::record(CommandList& commands, const In& in, const Out& out) const {
  const SceneInputs& s = in.scene;
  shared::PoseLightsPush push{};
  push.time_s = s.values->time_s;
  push.groups = commands.address(s.light_groups);
  push.instances = commands.address(s.light_instances);
  push.posed = commands.address(s.posed_lights ? s.posed_lights : s.light_groups);  // never read where there are none
  push.lights = commands.address(out.lights);
  push.group_count = s.light_group_count, push.light_count = s.values->light_count;
  commands.bind(out.pipeline);
  commands.push(push);
  const glm::uvec2 threads = shared::light_threads(s.values->light_count);
  commands.dispatch(threads.x, threads.y);
}

}  // namespace candela
