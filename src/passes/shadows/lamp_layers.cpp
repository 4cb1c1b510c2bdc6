#include "passes/shadows/lamp_layers.h"

namespace candela {

Need LampLayers::needed(const SceneFacts&, const FrameRequest& request) const {
  return needed_if(request.has_layer(layers[0].name),
                   "no layer of the shadows of point and spot lights is wanted (--layers)");
}

LampLayers::Out LampLayers::declare(GraphBuilder& builder, const In& in) const {
  declare_lights(builder, in.scene, in.lists);
  RunPipelineChoice choice;
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.fragment_shader = "lamp_layers.frag";
  choice.desc.color_formats = {VK_FORMAT_R32_SFLOAT};
  choice.desc.depth_format = depth_format;
  choice.desc.depth_test = choice.desc.depth_write = true;
  choice.desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  choice.desc.constants = light_constants(in.lists);
  Out out;
  out.pipelines = declare_runs(
      builder, in.scene, in.draws, in.deformed, [](const DrawRun& r) { return r.alpha != AlphaMode::blend; }, choice);
  const uint32_t width = in.scene.width_px, height = in.scene.height_px;
  out.depth =
      builder.write(builder.create(ImageDesc{"lamp_layers.z", depth_format, width, height}), Access::depth_attachment);
  const std::string layer(layers[0].name);
  ImageDesc desc{layer, VK_FORMAT_R32_SFLOAT, width, height};
  desc.clear = {1, 0, 0, 0};
  out.image = builder.write(builder.create(desc), Access::color_attachment);
  builder.publish(layer, out.image);
  return out;
}

void LampLayers::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment color{out.image};
  commands.begin_rendering({&color, 1}, out.depth);
  record_runs(commands, in.scene, in.draws, in.deformed, out.pipelines, &in.lists);
  commands.end_rendering();
}

}  // namespace candela
