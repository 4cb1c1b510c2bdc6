#include "passes/surfaces/surface_pass.h"

namespace candela {

template <bool lit>
Need SurfacePass<lit>::needed(const SceneFacts& facts, const FrameRequest&) const {
  if (lit) return needed_if(facts.lit_items > 0, "the scene has no opaque or masked surface that takes light");
  return needed_if(facts.unlit_items > 0, "the scene has no opaque or masked unlit surface");
}

template <bool lit>
typename SurfacePass<lit>::Out SurfacePass<lit>::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.depth, Access::depth_test, "depth");
  if (lit) declare_lights(builder, in.scene, in.lists);
  declare_fog(builder, in.scene, in.lists, lit);
  BatchPipelineChoice choice;
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.fragment_shader = with_fog(lit ? "shade_forward.frag" : "shade_unlit.frag", in.lists);
  if (lit) choice.desc.fragment_shader = with_shadow_colors(choice.desc.fragment_shader, in.lists.shadow_colors);
  choice.desc.color_formats = {color_format};
  choice.desc.depth_format = depth_format;
  choice.desc.samples = in.scene.samples;
  choice.desc.depth_test = true;
  choice.desc.depth_compare = VK_COMPARE_OP_EQUAL;
  if (lit) choice.desc.constants = light_constants(in.lists);
  Out out;
  out.pipelines = declare_batches(
      builder, in.scene, in.draws, in.deformed,
      [&](const DrawBatch& r) { return r.solid() && r.unlit != lit && (!in.lines_alone || r.is_lines()); }, choice);
  out.color = write_color(builder, in.scene, in.color);
  return out;
}

template <bool lit>
void SurfacePass<lit>::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment color{out.color};
  commands.begin_picture({&color, 1}, in.depth);
  record_batches(commands, in.scene, in.draws, in.deformed, out.pipelines, lit ? &in.lists : nullptr, &in.lists);
  commands.end_rendering();
}

template struct SurfacePass<true>;
template struct SurfacePass<false>;

}  // namespace candela
