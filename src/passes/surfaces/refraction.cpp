#include "passes/surfaces/refraction.h"

#include <bit>

#include "shared/refraction.h"

namespace candela {
namespace {
glm::uvec2 pyramid_px(const SceneInputs& scene) {
  return {std::bit_floor(scene.width_px), std::bit_floor(scene.height_px)};
}
uint32_t levels(const SceneInputs& scene) {
  const glm::uvec2 size = pyramid_px(scene);
  return uint32_t(std::bit_width(std::max(size.x, size.y)));
}
}  // namespace

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
  return needed_if(facts.refracting_items > 0, "the scene has no surface that refracts");
}

Refraction::Out Refraction::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& scene = in.scene;
  const glm::uvec2 size = pyramid_px(scene);
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
  ImageHandle& pyramid = out.seen.pyramid;
  pyramid = builder.create(ImageDesc{.name = "refraction.pyramid",
                                     .format = color_format,
                                     .width_px = size.x,
                                     .height_px = size.y,
                                     .mips = levels(scene)});
  for (uint32_t k = 0; k < levels(scene); ++k) {
    builder.begin_step();
    if (k == 0)
      builder.read(out.seen.picture, Access::sampled_compute, "the picture behind");
    else
      builder.read(pyramid, Access::sampled_compute, "the finer level", ImageRange::mip(k - 1));
    pyramid = builder.write(pyramid, Access::storage_image_write, ImageRange::mip(k));
  }
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
  if (step < copies + levels(in.scene)) {
    const SeenThrough& seen = out.seen;
    const uint32_t level = step - copies;  // beyond all of them while the picture is copied
    shared::RefractionDownPush push{};
    push.source = commands.sampled(step < copies ? in.picture : level == 0 ? seen.picture : seen.pyramid);
    push.target = commands.storage(step < copies ? seen.picture : seen.pyramid);
    push.source_px = step <= copies ? size : commands.size(seen.pyramid, level - 1);
    push.target_px = step < copies ? size : commands.size(seen.pyramid, level);
    commands.bind(out.down);
    commands.push(push);
    commands.dispatch(push.target_px.x, push.target_px.y);
    return;
  }
  const CommandList::Attachment color{out.color};
  commands.begin_rendering({&color, 1}, in.depth);
  record_runs(commands, in.scene, in.draws, in.deformed, out.pipelines, &in.lists, &in.lists,
              own_inputs(commands, out.seen));
  commands.end_rendering();
}

}  // namespace candela
