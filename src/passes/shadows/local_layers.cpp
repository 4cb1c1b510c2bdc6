#include "passes/shadows/local_layers.h"

namespace candela {

Need LocalLayers::needed(const SceneFacts&, const FrameRequest& request) const {
  return needed_if(request.has_layer(layers[0].name),
                   "no layer of the shadows of point and spot lights is wanted (--layers)");
}

LocalLayers::Out LocalLayers::declare(GraphBuilder& builder, const In& in) const {
  declare_lights(builder, in.scene, in.lists);
  Out out;
  out.drawn = declare_nearest_surface(builder, in.scene, in.draws, in.deformed, name, "local_layers.frag",
                                      {VK_FORMAT_R32_SFLOAT}, light_constants(in.lists));
  const std::string layer(layers[0].name);
  ImageDesc desc{layer, VK_FORMAT_R32_SFLOAT, in.scene.width_px, in.scene.height_px};
  desc.clear = {1, 0, 0, 0};
  out.image = builder.write(builder.create(desc), Access::color_attachment);
  builder.publish(layer, out.image);
  return out;
}

void LocalLayers::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment color{out.image};
  commands.begin_picture({&color, 1}, out.drawn.depth);
  record_batches(commands, in.scene, in.draws, in.deformed, out.drawn.pipelines, &in.lists);
  commands.end_rendering();
}

}  // namespace candela
