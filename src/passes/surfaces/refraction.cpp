#include "passes/surfaces/refraction.h"

#include "shared/refraction.h"

namespace candela {

std::span<const Knob<Refraction::Knobs>> Refraction::Knobs::table() {
  static const Knob<Knobs> table[] = {
      {.name = "samples",
       .member = &Knobs::samples,
       .lowest = 0,
       .highest = 1024,
       .ladder = {0, 4, 8, 64},
       .trades =
           "directions through a rough surface, each followed to the depth seen there; fewer leave copies of what "
           "is behind; 0: one look-up, blurred by roughness and index alone, however far what is behind lies",
       .walk = {0, 1, 4, 8, 16, 64},
       .passes = {"refraction"}},
  };
  return table;
}

Need Refraction::needed(const SceneFacts& facts, const FrameRequest& request) const {
  if (!request.wants_true(effect)) return {false, "refraction is not wanted (--effects, --quality)"};
  if (request.transparency == "phenomenological")
    return {false, "--transparency phenomenological draws what refracts together with blended surfaces"};
  return needed_if(facts.refracting_items > 0, "the scene has no surface that refracts");
}

Refraction::Out Refraction::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& scene = in.scene;
  Out out;
  out.down = builder.pipeline(ComputePipelineDesc{"refraction_down.comp", {}});
  out.seen = {.picture = in.picture, .behind = in.behind, .lobe_samples = uint32_t(knobs.samples)};
  // Not the image that is drawn to.
  if (scene.samples == 1) {
    builder.begin_step();
    builder.read(in.picture, Access::sampled_compute, "the picture behind");
    out.seen.picture =
        builder.write(builder.create(ImageDesc{"refraction.copy", color_format, scene.width_px, scene.height_px}),
                      Access::storage_image_write);
  }
  out.seen.pyramid = declare_pyramid(builder, scene, out.seen.picture, "refraction.pyramid");
  builder.begin_step();
  builder.read(in.depth, Access::depth_test, "depth");
  declare_lights(builder, scene, in.lists);
  declare_fog(builder, scene, in.lists, true);
  RunPipelineChoice choice;
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.fragment_shader = with_fog("shade_forward.frag", in.lists);
  choice.desc.color_formats = {color_format};
  choice.desc.depth_format = depth_format;
  choice.desc.samples = scene.samples;
  choice.desc.depth_test = true;
  choice.desc.depth_compare = VK_COMPARE_OP_EQUAL;
  choice.desc.constants = light_constants(in.lists);
  declare_seen_through(builder, scene, out.seen, choice);
  out.pipelines = declare_runs(
      builder, scene, in.draws, in.deformed, [](const DrawRun& r) { return r.refracts; }, choice);
  out.color = builder.write(in.color, Access::color_attachment);
  return out;
}

void Refraction::record(CommandList& commands, const In& in, const Out& out) const {
  const glm::uvec2 size(in.scene.width_px, in.scene.height_px);
  const uint32_t copies = in.scene.samples == 1 ? 1 : 0, step = commands.step();
  if (step < copies) {
    commands.bind(out.down);
    commands.push(
        shared::RefractionDownPush{commands.sampled(in.picture), commands.storage(out.seen.picture), size, size});
    commands.dispatch(size.x, size.y);
    return;
  }
  if (step < copies + pyramid_levels(in.scene)) {
    record_level(commands, out.down, out.seen.picture, out.seen.pyramid, size, step - copies);
    return;
  }
  const CommandList::Attachment color{out.color};
  commands.begin_rendering({&color, 1}, in.depth);
  record_runs(commands, in.scene, in.draws, in.deformed, out.pipelines, &in.lists, &in.lists,
              own_inputs(commands, out.seen));
  commands.end_rendering();
}

}  // namespace candela
