#include "passes/occlusion/occlusion_layer.h"

namespace candela {
namespace {

Lighting lists_of(const OcclusionLayer::In& in) {
  Lighting lists;
  lists.occlusion = in.occlusion;
  lists.rays = in.rays;
  lists.rays.suns = lists.rays.lamps = lists.rays.soft_suns = lists.rays.soft_lamps = false;
  return lists;
}

}  // namespace

Need OcclusionLayer::needed(const SceneFacts&, const FrameRequest& request) const {
  return needed_if(request.has_layer(layers[0].name), "the layer of ambient occlusion is not wanted (--layers)");
}

OcclusionLayer::Out OcclusionLayer::declare(GraphBuilder& builder, const In& in) const {
  declare_lights(builder, in.scene, lists_of(in));
  Out out;
  out.drawn = declare_nearest_surface(builder, in.scene, in.draws, in.deformed, name, "occlusion_layer.frag",
                                      {VK_FORMAT_R32_SFLOAT}, light_constants(lists_of(in)));
  const std::string layer(layers[0].name);
  ImageDesc desc{layer + ".layer", VK_FORMAT_R32_SFLOAT, in.scene.width_px, in.scene.height_px};
  desc.clear = {1, 0, 0, 0};
  out.layer = builder.write(builder.create(desc), Access::color_attachment);
  builder.publish(layer, out.layer);
  return out;
}

void OcclusionLayer::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment color{out.layer};
  const Lighting lists = lists_of(in);
  commands.begin_picture({&color, 1}, out.drawn.depth);
  record_batches(commands, in.scene, in.draws, in.deformed, out.drawn.pipelines, &lists);
  commands.end_rendering();
}

}  // namespace candela
