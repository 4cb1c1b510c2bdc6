#include "passes/shadows/sun_layers.h"

namespace candela {

Need SunLayers::needed(const SceneFacts&, const FrameRequest& request) const {
  for (const LayerName& layer : layers)
    if (request.has_layer(layer.name)) return {};
  return {false, "no layer of the suns' shadows is wanted (--layers)"};
}

SunLayers::Out SunLayers::declare(GraphBuilder& builder, const In& in) const {
  declare_lights(builder, in.scene, in.lists);
  Out out;
  out.drawn = declare_nearest_surface(builder, in.scene, in.draws, in.deformed, name, "sun_layers.frag",
                                      std::vector<VkFormat>(std::size(layers), VK_FORMAT_R32_SFLOAT),
                                      light_constants(in.lists));
  for (size_t i = 0; i < std::size(layers); ++i) {
    const std::string layer(layers[i].name);
    ImageDesc desc{layer, VK_FORMAT_R32_SFLOAT, in.scene.width_px, in.scene.height_px};
    if (i == 0) desc.clear = {1, 0, 0, 0};
    out.images[i] = builder.write(builder.create(desc), Access::color_attachment);
    builder.publish(layer, out.images[i]);
  }
  return out;
}

void SunLayers::record(CommandList& commands, const In& in, const Out& out) const {
  std::vector<CommandList::Attachment> colors;
  for (const ImageHandle image : out.images) colors.push_back({image});
  commands.begin_picture(colors, out.drawn.depth);
  record_batches(commands, in.scene, in.draws, in.deformed, out.drawn.pipelines, &in.lists);
  commands.end_rendering();
}

}  // namespace candela
