#include "passes/surfaces/shade_gbuffer.h"

#include "passes/shared/draw_batches.h"
#include "passes/shared/features.h"

namespace candela {

Need ShadeGBuffer::needed(const SceneFacts& facts, const FrameRequest&) const {
  return needed_for_solid_surfaces(facts);
}

ShadeGBuffer::Out ShadeGBuffer::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  read_gbuffer(builder, in.gbuffer, Access::sampled_compute);
  read_gbuffer_reliefs(builder, in.gbuffer, s, in.deformed, Access::compute_read);
  declare_lights(builder, s, in.lists, ReadBy::compute());
  declare_fog(builder, s, in.lists, true, ReadBy::compute());
  ComputePipelineDesc desc{
      with_shadow_colors(with_fog("shade_gbuffer.comp" + in.gbuffer.definitions, in.lists), in.lists.shadow_colors),
      light_constants(in.lists)};
  desc.constants.insert(desc.constants.end(), s.features.begin(), s.features.end());
  desc.constants.push_back({30, "SAMPLES", s.samples});
  desc.shader += surface_definitions(desc.constants);
  Out out;
  out.samples = declare_sample_store(builder, s, name, desc.shader);
  out.pipeline = builder.pipeline(desc);
  return out;
}

void ShadeGBuffer::record(CommandList& commands, const In& in, const Out& out) const {
  OwnInputs own;
  own.word = gbuffer_places(commands, in.gbuffer);
  push_sample_store(commands, out.samples, own);
  commands.bind(out.pipeline);
  const BufferHandle deformed = in.gbuffer.reliefs ? in.deformed : BufferHandle{};
  commands.push(draw_push(commands, in.scene, deformed, &in.lists, &in.lists, own));
  commands.dispatch_picture(in.scene.width_px, in.scene.height_px);
}

}  // namespace candela
