#include "passes/debug/layers.h"

namespace candela {
namespace {
constexpr VkFormat formats[layer_count] = {VK_FORMAT_R32_SFLOAT, color_format,       color_format,
                                           VK_FORMAT_R32_UINT,   VK_FORMAT_R32_UINT, color_format};
constexpr float no_id = -1;  // clear values travel as floats; -1 wraps to 0xffffffff in an unsigned format

}  // namespace

Need Layers::needed(const SceneFacts&, const FrameRequest& request) const {
  for (const LayerName& layer : layers)
    if (request.has_layer(layer.name)) return {};
  return {false, "no layer beside beauty is wanted (--layers)"};
}

Layers::Out Layers::declare(GraphBuilder& builder, const In& in) const {
  if (in.wanted[size_t(Layer::direct)]) declare_lights(builder, in.scene, in.lists);
  Out out;
  RunPipelineChoice choice;
  if (in.wanted[size_t(Layer::direct)]) choice.desc.constants = light_constants(in.lists);
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.fragment_shader = "layers.frag";
  choice.desc.depth_format = depth_format;
  choice.desc.depth_test = choice.desc.depth_write = true;
  choice.desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  // Only wanted layers are attachments, and outputs of the shader, in the order of the table.
  for (uint32_t i = 0; i < layer_count; ++i) {
    if (!in.wanted[i]) continue;
    std::string define(layers[i].name);
    std::transform(define.begin(), define.end(), define.begin(), [](unsigned char c) { return char(std::toupper(c)); });
    choice.desc.fragment_shader += fmt::format("#{}={}", define, choice.desc.color_formats.size());
    choice.desc.color_formats.push_back(formats[i]);
  }
  out.pipelines = declare_runs(
      builder, in.scene, in.draws, in.deformed, [](const DrawRun& r) { return r.alpha != AlphaMode::blend; }, choice);
  out.depth = builder.write(builder.create(ImageDesc{"layers.z", depth_format, in.scene.width_px, in.scene.height_px}),
                            Access::depth_attachment);
  for (uint32_t i = 0; i < layer_count; ++i) {
    if (!in.wanted[i]) continue;
    ImageDesc desc{"layers." + std::string(layers[i].name), formats[i], in.scene.width_px, in.scene.height_px};
    if (Layer(i) == Layer::depth) desc.clear = {1e10f, 0, 0, 0};
    if (Layer(i) == Layer::object_id || Layer(i) == Layer::material_id) desc.clear = {no_id, 0, 0, 0};
    out.images[i] = builder.write(builder.create(desc), Access::color_attachment);
    builder.publish(std::string(layers[i].name), out.images[i]);
  }
  return out;
}

void Layers::record(CommandList& commands, const In& in, const Out& out) const {
  std::vector<CommandList::Attachment> colors;
  for (const ImageHandle image : out.images)
    if (image) colors.push_back({image});
  commands.begin_rendering(colors, out.depth);
  record_runs(commands, in.scene, in.draws, in.deformed, out.pipelines,
              in.wanted[size_t(Layer::direct)] ? &in.lists : nullptr);
  commands.end_rendering();
}

}  // namespace candela
