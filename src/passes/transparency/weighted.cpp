#include "passes/transparency/weighted.h"

#include "shared/transparency.h"

namespace candela {

Need Weighted::needed(const SceneFacts& facts, const FrameRequest& request) const {
  return needs_method(facts, request, method);
}

Weighted::Out Weighted::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  Out out;
  out.sum = builder.create(ImageDesc{"weighted.sum", color_format, s.width_px, s.height_px, s.samples});
  out.covered = builder.create(ImageDesc{"weighted.covered", VK_FORMAT_R32_SFLOAT, s.width_px, s.height_px, s.samples});

  builder.begin_step();
  GraphicsPipelineDesc drawn;
  drawn.color_formats = {color_format, VK_FORMAT_R32_SFLOAT};
  // Coverage as what it absorbs, so that both add up: lavapipe 25.0.7 blends all attachments as the first where the
  // first pipeline of a device's queue had fewer than two.
  drawn.blend = Blend::additive;
  out.drawn = declare_blended(builder, in, drawn, "#WEIGHTED=1");
  out.sum = builder.write(out.sum, Access::color_attachment);
  out.covered = builder.write(out.covered, Access::color_attachment);

  builder.begin_step();
  builder.read(out.sum, Access::sampled_fragment, "sums");
  builder.read(out.covered, Access::sampled_fragment, "coverage");
  GraphicsPipelineDesc over;
  over.vertex_shader = "background.vert", over.fragment_shader = "weighted_over.frag";
  over.constants = {{0, "SAMPLES", s.samples}};
  over.color_formats = {color_format};
  over.samples = s.samples;
  over.blend = Blend::premultiplied_over;
  out.over = builder.pipeline(over);
  out.color = builder.write(in.color, Access::color_attachment);
  return out;
}

void Weighted::record(CommandList& commands, const In& in, const Out& out) const {
  if (commands.step() == 0) {
    const CommandList::Attachment sums[] = {{out.sum}, {out.covered}};
    commands.begin_rendering(sums, in.depth);
    record_runs(commands, in.scene, in.draws, in.deformed, out.drawn, &in.lists, &in.lists);
  } else {
    const CommandList::Attachment color{out.color};
    commands.begin_rendering({&color, 1}, {});
    commands.bind(out.over);
    draw_samples(commands, in.scene.samples,
                 shared::SumsPush{commands.sampled(out.sum), commands.sampled(out.covered), 0});
  }
  commands.end_rendering();
}

}  // namespace candela
