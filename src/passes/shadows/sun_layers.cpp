#include "passes/shadows/sun_layers.h"

namespace candela {

Need SunLayers::needed(const SceneFacts&, const FrameRequest& request) const {
  for (const LayerName& layer : layers)
    if (request.has_layer(layer.name)) return {};
  return {false, "no layer of the suns' shadows is wanted (--layers)"};
}

SunLayers::Out SunLayers::declare(GraphBuilder& builder, const In& in) const {
  declare_lights(builder, in.scene, in.lists);
  RunPipelineChoice choice;
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.fragment_shader = "sun_layers.frag";
  choice.desc.color_formats.assign(std::size(layers), VK_FORMAT_R32_SFLOAT);
  choice.desc.depth_format = depth_format;
  choice.desc.depth_test = choice.desc.depth_write = true;
  choice.desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  choice.desc.constants = light_constants(in.lists);
  Out out;
  out.pipelines = declare_runs(
      builder, in.scene, in.draws, in.deformed, [](const DrawRun& r) { return r.alpha != AlphaMode::blend; }, choice);
  const uint32_t width = in.scene.width_px, height = in.scene.height_px;
  out.depth =
      builder.write(builder.create(ImageDesc{"sun_layers.z", depth_format, width, height}), Access::depth_attachment);
  for (size_t i = 0; i < std::size(layers); ++i) {
    const std::string layer(layers[i].name);
    ImageDesc desc{layer, VK_FORMAT_R32_SFLOAT, width, height};
    if (i == 0) desc.clear = {1, 0, 0, 0};
    out.images[i] = builder.write(builder.create(desc), Access::color_attachment);
    builder.publish(layer, out.images[i]);
  }
  return out;
}

void SunLayers::record(CommandList& commands, const In& in, const Out& out) const {
  std::vector<CommandList::Attachment> colors;
  for (const ImageHandle image : out.images) colors.push_back({image});
  commands.begin_rendering(colors, out.depth);
  record_runs(commands, in.scene, in.draws, in.deformed, out.pipelines, &in.lists);
  commands.end_rendering();
}

}  // namespace candela
