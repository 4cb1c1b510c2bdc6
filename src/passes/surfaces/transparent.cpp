#include "passes/surfaces/transparent.h"

namespace candela {

Need Transparent::needed(const SceneFacts& facts, const FrameRequest&) const {
  return needed_if(facts.blend_items > 0, "the scene has no blended surface");
}

Transparent::Out Transparent::declare(GraphBuilder& builder, const In& in) const {
  const bool tested = builder.read_optional(in.depth, Access::depth_test);
  declare_lights(builder, in.scene, in.lists);
  declare_fog(builder, in.scene, in.lists, true);
  RunPipelineChoice choice;
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.color_formats = {color_format};
  choice.desc.depth_format = tested ? depth_format : VK_FORMAT_UNDEFINED;
  choice.desc.samples = in.scene.samples;
  choice.desc.depth_test = tested;
  choice.desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  choice.desc.blend = Blend::premultiplied_over;
  Out out;
  choice.desc.fragment_shader = with_fog("shade_forward.frag", in.lists);
  choice.desc.constants = light_constants(in.lists);
  out.lit = declare_runs(
      builder, in.scene, in.draws, in.deformed,
      [](const DrawRun& r) { return r.alpha == AlphaMode::blend && !r.unlit; }, choice);
  choice.desc.fragment_shader = with_fog("shade_unlit.frag", in.lists);
  choice.desc.constants = {};
  out.unlit = declare_runs(
      builder, in.scene, in.draws, in.deformed, [](const DrawRun& r) { return r.alpha == AlphaMode::blend && r.unlit; },
      choice);
  out.color = write_color(builder, in.scene, in.color);
  return out;
}

void Transparent::record(CommandList& commands, const In& in, const Out& out) const {
  // Lit and unlit runs interleave by depth, so they go out in one walk.
  RunPipelines all = out.lit;
  for (size_t r = 0; r < all.by_run.size(); ++r)
    if (out.unlit.by_run[r]) all.by_run[r] = out.unlit.by_run[r];
  const CommandList::Attachment color{out.color};
  commands.begin_rendering({&color, 1}, in.depth);
  record_runs(commands, in.scene, in.draws, in.deformed, all, &in.lists, &in.lists);
  commands.end_rendering();
}

}  // namespace candela
