#include "passes/debug/light_heat.h"

namespace candela {

Need LightHeat::needed(const SceneFacts&, const FrameRequest& request) const {
  for (const LayerName& layer : layers)
    if (request.has_layer(layer.name)) return {};
  return {false, "no heat map of the light lists is wanted (--view, --layers)"};
}

LightHeat::Out LightHeat::declare(GraphBuilder& builder, const In& in) const {
  declare_lights(builder, in.scene, in.lists);
  RunPipelineChoice choice;
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.fragment_shader = "light_heat.frag";
  choice.desc.color_formats.assign(std::size(layers), VK_FORMAT_R32_SFLOAT);
  choice.desc.depth_format = depth_format;
  choice.desc.depth_test = choice.desc.depth_write = true;
  choice.desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  Out out;
  out.pipelines = declare_runs(
      builder, in.scene, in.draws, in.deformed, [](const DrawRun& r) { return r.alpha != AlphaMode::blend; }, choice);
  const uint32_t width = in.scene.width_px, height = in.scene.height_px;
  out.depth =
      builder.write(builder.create(ImageDesc{"heatmap.z", depth_format, width, height}), Access::depth_attachment);
  for (size_t i = 0; i < std::size(layers); ++i) {
    const std::string layer(layers[i].name);
    out.counts[i] =
        builder.write(builder.create(ImageDesc{layer, VK_FORMAT_R32_SFLOAT, width, height}), Access::color_attachment);
    builder.publish(layer, out.counts[i]);
  }
  return out;
}

void LightHeat::record(CommandList& commands, const In& in, const Out& out) const {
  std::vector<CommandList::Attachment> colors;
  for (const ImageHandle image : out.counts) colors.push_back({image});
  commands.begin_rendering(colors, out.depth);
  record_runs(commands, in.scene, in.draws, in.deformed, out.pipelines, &in.lists);
  commands.end_rendering();
}

}  // namespace candela
