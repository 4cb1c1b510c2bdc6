#include "passes/sky/background.h"

#include "shared/draw.h"

namespace candela {

Need Background::needed(const SceneFacts& facts, const FrameRequest& request) const {
  return needed_if(!(facts.environment && request.draw_background), "the sky is behind everything");
}

Background::Out Background::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  if (!in.color) {
    const ImageHandle cleared =
        builder.create(ImageDesc{"color", color_format, s.width_px, s.height_px, s.samples, s.background});
    return {builder.write(cleared, Access::color_attachment), {}};
  }
  builder.read(in.depth, Access::depth_test, "depth");
  GraphicsPipelineDesc desc;
  desc.vertex_shader = "background.vert";
  desc.fragment_shader = "background.frag";
  desc.color_formats = {color_format};
  desc.depth_format = depth_format;
  desc.samples = s.samples;
  desc.depth_test = true;
  desc.depth_compare = VK_COMPARE_OP_EQUAL;
  const PipelineHandle pipeline = builder.pipeline(desc);
  return {write_color(builder, s, in.color), pipeline};
}

void Background::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment color{out.color};
  commands.begin_rendering({&color, 1}, out.pipeline ? in.depth : ImageHandle{});
  if (out.pipeline) {
    commands.bind(out.pipeline);
    const auto& [r, g, b, a] = in.scene.background;
    commands.push(shared::BackgroundPush{{r, g, b, a}});
    commands.set_cull(false, false);
    commands.draw(3);
  }
  commands.end_rendering();
}

}  // namespace candela
