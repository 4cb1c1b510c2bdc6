#include "passes/debug/light_heat.h"

namespace candela {

Need LightHeat::needed(const SceneFacts&, const FrameRequest& request) const {
  for (const LayerName& layer : layers)
    if (request.has_layer(layer.name)) return {};
  return {false, "no heat map of the light lists is wanted (--view, --layers)"};
}

LightHeat::Out LightHeat::declare(GraphBuilder& builder, const In& in) const {
  declare_lights(builder, in.scene, in.lists);
  Out out;
  out.drawn = declare_nearest_surface(builder, in.scene, in.draws, in.deformed, "heatmap", "light_heat.frag",
                                      std::vector<VkFormat>(std::size(layers), VK_FORMAT_R32_SFLOAT));
  const uint32_t width = in.scene.width_px, height = in.scene.height_px;
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
  commands.begin_picture(colors, out.drawn.depth);
  record_batches(commands, in.scene, in.draws, in.deformed, out.drawn.pipelines, &in.lists);
  commands.end_rendering();
}

}  // namespace candela
