#include "passes/volumes/fog_march.h"

#include "passes/shared/push_lights.h"
#include "shared/fog.h"

namespace candela {

Need FogMarch::needed(const SceneFacts& facts, const FrameRequest& request) const {
  if (Need any = fog_light_needed(facts, request); !any) return any;
  return needed_if(shared_knobs.method == FogKnobs::march, "fog.method is not march");
}

FogMarch::Out FogMarch::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  const uint32_t side = uint32_t(shared_knobs.march_px);
  Out out;
  out.light = builder.create(ImageDesc{.name = "fog.texels",
                                       .format = color_format,
                                       .width_px = (s.width_px + side - 1) / side,
                                       .height_px = (s.height_px + side - 1) / side});
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  if (in.depth) read_depth(builder, in.depth);
  for (const BufferHandle b : {s.lights, s.light_globals, in.lists.cells, in.lists.entries})
    builder.read_optional(b, Access::compute_read);
  const bool lamps = in.lists.lamp_maps && shared_knobs.local_shadows > 0;
  if (in.lists.sun_maps) {
    builder.read(in.lists.sun_maps, Access::sampled_compute, "the suns' maps");
    builder.read(s.suns, Access::compute_read, "the suns' cascades");
  }
  if (in.lists.sun_maps) builder.read_optional(in.lists.deep.suns, Access::sampled_compute);
  if (lamps) {
    builder.read_optional(in.lists.deep.lamps, Access::sampled_compute);
    builder.read(in.lists.lamp_maps, Access::sampled_compute, "the local lights' maps");
    builder.read(s.lamps, Access::compute_read, "the local lights' tiles");
  }
  std::string shader = with_depth("fog_march.comp", in.depth);
  if (in.media > 0) shader += fmt::format("#FOG_MEDIA={}", in.media);
  if (in.ambient) shader += "#FOG_AMBIENT=1";
  shader += fog_shadows(in.lists, shared_knobs.local_shadows, 1);  // where the texel's noise says
  out.pipeline = builder.pipeline(ComputePipelineDesc{shader, {{0, "DEPTH_SAMPLES", in.depth ? s.samples : 0}}});
  out.light = builder.write(out.light, Access::storage_image_write);
  return out;
}

void FogMarch::record(CommandList& commands, const In& in, const Out& out) const {
  shared::FogMarchPush push{};
  Lighting lists = in.lists;
  lists.tiles = {};  // air lies before and behind what tiles know the depths of
  if (shared_knobs.local_shadows == 0) lists.lamp_maps = lists.deep.lamps = {};
  if (!lists.sun_maps) lists.deep.suns = {};
  push_light_lists(commands, in.scene, lists, push);
  push_depth(commands, in.depth, push);
  push.target = commands.storage(out.light);
  push.texels = commands.size(out.light);
  push.texel_px = uint32_t(shared_knobs.march_px), push.steps = uint32_t(shared_knobs.march_steps);
  push.loss = shared_knobs.march_loss;
  push.seed = in.seed;
  commands.bind(out.pipeline);
  commands.push(push);
  commands.dispatch_picture(push.texels.x, push.texels.y, PicturePart::shaded, push.texel_px);
}

}  // namespace candela
