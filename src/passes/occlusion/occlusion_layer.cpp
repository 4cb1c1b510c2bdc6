#include "passes/occlusion/occlusion_layer.h"

namespace candela {
namespace {

CellLists lists_of(const OcclusionLayer::In& in) {
  CellLists lists;
  lists.occlusion = in.occlusion;
  return lists;
}

}  // namespace

Need OcclusionLayer::needed(const SceneFacts&, const FrameRequest& request) const {
  return needed_if(request.has_layer(layers[0].name), "the layer of ambient occlusion is not wanted (--layers)");
}

OcclusionLayer::Out OcclusionLayer::declare(GraphBuilder& builder, const In& in) const {
  declare_lights(builder, in.scene, lists_of(in));
  RunPipelineChoice choice;
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.fragment_shader = "occlusion_layer.frag";
  choice.desc.color_formats = {VK_FORMAT_R32_SFLOAT};
  choice.desc.depth_format = depth_format;
  choice.desc.depth_test = choice.desc.depth_write = true;
  choice.desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  choice.desc.constants = light_constants(lists_of(in));
  Out out;
  out.pipelines = declare_runs(
      builder, in.scene, in.draws, in.deformed, [](const DrawRun& r) { return r.alpha != AlphaMode::blend; }, choice);
  const uint32_t width = in.scene.width_px, height = in.scene.height_px;
  out.depth = builder.write(builder.create(ImageDesc{"occlusion_layer.z", depth_format, width, height}),
                            Access::depth_attachment);
  const std::string layer(layers[0].name);
  ImageDesc desc{layer + ".layer", VK_FORMAT_R32_SFLOAT, width, height};
  desc.clear = {1, 0, 0, 0};
  out.layer = builder.write(builder.create(desc), Access::color_attachment);
  builder.publish(layer, out.layer);
  return out;
}

void OcclusionLayer::record(CommandList& commands, const In& in, const Out& out) const {
  const CommandList::Attachment color{out.layer};
  const CellLists lists = lists_of(in);
  commands.begin_rendering({&color, 1}, out.depth);
  record_runs(commands, in.scene, in.draws, in.deformed, out.pipelines, &lists);
  commands.end_rendering();
}

}  // namespace candela
