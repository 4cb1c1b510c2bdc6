#include "passes/sky/sky.h"

#include "shared/draw.h"

namespace candela {

Need Sky::needed(const SceneFacts& facts, const FrameRequest& request) const {
  if (!facts.environment) return {false, "no sky image is given (--sky)"};
  return needed_if(!request.sky_hidden, "the studio is not seen: the background is (--background)");
}

Sky::Out Sky::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  const bool tested = builder.read_optional(in.depth, Access::depth_test);
  GraphicsPipelineDesc desc;
  desc.vertex_shader = "background.vert";
  declare_fog(builder, in.scene, in.lists);
  desc.fragment_shader = with_fog("sky.frag", in.lists);
  if (in.lists.fog && !in.fog_glows) desc.fragment_shader += "#WITHOUT_FOG_LIGHT=1";
  desc.color_formats = {color_format};
  desc.depth_format = tested ? depth_format : VK_FORMAT_UNDEFINED;
  desc.samples = in.scene.samples;
  desc.depth_test = tested;
  desc.depth_compare = VK_COMPARE_OP_EQUAL;
  Out out;
  if (in.scene.is_subsample) desc.constants.push_back({14, "IS_SUBSAMPLE", 1});
  out.pipeline = builder.pipeline(desc);
  out.color = write_color(builder, in.scene, in.color);
  return out;
}

void Sky::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment color{out.color};
  commands.begin_picture({&color, 1}, in.depth);
  commands.bind(out.pipeline);
  commands.push(sky_push(commands, in.scene, in.lists));
  commands.set_cull(false, false);
  commands.draw(3);
  commands.end_rendering();
}

}  // namespace candela
