#include "passes/surfaces/shade_unlit.h"

namespace candela {

Need ShadeUnlit::needed(const SceneFacts& facts, const FrameRequest&) const {
  return needed_if(facts.unlit_items > 0, "the scene has no opaque or masked unlit surface");
}

ShadeUnlit::Out ShadeUnlit::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.depth, Access::depth_test, "depth");
  RunPipelineChoice choice;
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.fragment_shader = "shade_unlit.frag";
  choice.desc.color_formats = {color_format};
  choice.desc.depth_format = depth_format;
  choice.desc.samples = in.scene.samples;
  choice.desc.depth_test = true;
  choice.desc.depth_compare = VK_COMPARE_OP_EQUAL;
  Out out;
  out.pipelines = declare_runs(
      builder, in.scene, in.draws, in.deformed, [](const DrawRun& r) { return r.alpha != AlphaMode::blend && r.unlit; },
      choice);
  out.color = write_color(builder, in.scene, in.color);
  return out;
}

void ShadeUnlit::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment color{out.color};
  commands.begin_rendering({&color, 1}, in.depth);
  record_runs(commands, in.scene, in.draws, in.deformed, out.pipelines);
  commands.end_rendering();
}

}  // namespace candela
