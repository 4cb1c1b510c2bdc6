#include "passes/surfaces/transparent.h"

namespace candela {

Need Transparent::needed(const SceneFacts& facts, const FrameRequest& request) const {
  if (behind) return needed_if(facts.blend_items > 0, "the scene has no blended surface");
  return needs_method(facts, request, method);
}

Transparent::Out Transparent::declare(GraphBuilder& builder, const In& in) const {
  const std::string behind =
      builder.read_optional(in.glass, Access::sampled_fragment) ? fmt::format("#BEHIND={}", in.scene.samples) : "";
  GraphicsPipelineDesc desc;
  desc.color_formats = {color_format};
  desc.blend = Blend::premultiplied_over;
  Out out;
  out.drawn = declare_blended(builder, in, desc, behind);
  out.color = write_color(builder, in.scene, in.color);
  return out;
}

void Transparent::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment color{out.color};
  commands.begin_picture({&color, 1}, in.depth);
  OwnInputs own;
  if (in.glass) own.number = commands.sampled(in.glass);
  record_batches(commands, in.scene, in.draws, in.deformed, out.drawn, &in.lists, &in.lists, own);
  commands.end_rendering();
}

}  // namespace candela
