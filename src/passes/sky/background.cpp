#include "passes/sky/background.h"

#include "shared/draw.h"

namespace candela {

Need Background::needed(const SceneFacts& facts, const FrameRequest& request) const {
  return needed_if(!(facts.environment && !request.sky_hidden), "the sky is behind everything");
}

Background::Out Background::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  if (!in.color && !in.lists.fog) {
    const ImageHandle cleared =
        builder.create(ImageDesc{"color", color_format, s.width_px, s.height_px, s.samples, s.background});
    return {builder.write(cleared, Access::color_attachment), {}};
  }
  const bool tested = bool(in.depth) || !in.lists.fog;
  if (tested) builder.read(in.depth, Access::depth_test, "depth");
  if (in.lists.fog) builder.read(s.constants, Access::uniform_read, "the frame's constants");
  declare_fog(builder, s, in.lists);
  GraphicsPipelineDesc desc;
  desc.vertex_shader = "background.vert";
  desc.fragment_shader = with_fog("background.frag", in.lists);
  if (in.lists.fog && !in.fog_glows) desc.fragment_shader += "#WITHOUT_FOG_LIGHT=1";
  desc.color_formats = {color_format};
  desc.depth_format = tested ? depth_format : VK_FORMAT_UNDEFINED;
  desc.samples = s.samples;
  desc.depth_test = tested;
  desc.depth_compare = VK_COMPARE_OP_EQUAL;
  const PipelineHandle pipeline = builder.pipeline(desc);
  return {write_color(builder, s, in.color), pipeline};
}

void Background::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment color{out.color};
  commands.begin_picture({&color, 1}, out.pipeline ? in.depth : ImageHandle{});
  if (out.pipeline) {
    commands.bind(out.pipeline);
    const auto& [r, g, b, a] = in.scene.background;
    const shared::SkyPush sky = sky_push(commands, in.scene, in.lists);
    commands.push(shared::BackgroundPush{sky.lights,
                                         sky.light_cells,
                                         sky.light_entries,
                                         sky.light_tiles,
                                         sky.suns,
                                         sky.lamps,
                                         {r, g, b, a},
                                         sky.subsample_ndc,
                                         sky.sun_maps,
                                         sky.lamp_maps,
                                         sky.fog_light,
                                         sky.shadow_colors});
    commands.set_cull(false, false);
    commands.draw(3);
  }
  commands.end_rendering();
}

}  // namespace candela
