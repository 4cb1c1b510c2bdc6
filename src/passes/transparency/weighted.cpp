#include "passes/transparency/weighted.h"

namespace candela {

Need Weighted::needed(const SceneFacts& facts, const FrameRequest& request) const {
  return needs_method(facts, request, method);
}

Weighted::Out Weighted::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  Out out;
  out.sum = builder.create(ImageDesc{"weighted.sum", color_format, s.width_px, s.height_px, s.samples});
  out.absorbed =
      builder.create(ImageDesc{"weighted.absorbed", VK_FORMAT_R32_SFLOAT, s.width_px, s.height_px, s.samples});

  builder.begin_step();
  GraphicsPipelineDesc drawn;
  drawn.color_formats = {color_format, VK_FORMAT_R32_SFLOAT};
  drawn.blend = Blend::additive;
  out.drawn = declare_blended(builder, in, drawn, "#WEIGHTED=1");
  out.sum = builder.write(out.sum, Access::color_attachment);
  out.absorbed = builder.write(out.absorbed, Access::color_attachment);

  builder.begin_step();
  out.over = declare_sums_over(builder, s, out.sum, out.absorbed);
  out.color = builder.write(in.color, Access::color_attachment);
  return out;
}

void Weighted::record(CommandList& commands, const In& in, const Out& out) const {
  if (commands.step() == 1) return record_sums_over(commands, in.scene, out.over, out.sum, out.absorbed, out.color);
  const CommandList::Attachment sums[] = {{out.sum}, {out.absorbed}};
  commands.begin_picture(sums, in.depth);
  record_batches(commands, in.scene, in.draws, in.deformed, out.drawn, &in.lists, &in.lists);
  commands.end_rendering();
}

}  // namespace candela
