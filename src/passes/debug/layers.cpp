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
  std::string shader = "layers.frag";
  std::vector<VkFormat> wanted_formats;
  // Only wanted layers are attachments, and outputs of the shader, in the order of the table.
  for (uint32_t i = 0; i < layer_count; ++i) {
    if (!in.wanted[i]) continue;
    std::string define(layers[i].name);
    std::transform(define.begin(), define.end(), define.begin(), [](unsigned char c) { return char(std::toupper(c)); });
    shader += fmt::format("#{}={}", define, wanted_formats.size());
    wanted_formats.push_back(formats[i]);
  }
  out.drawn = declare_nearest_surface(
      builder, in.scene, in.draws, in.deformed, name, shader, wanted_formats,
      in.wanted[size_t(Layer::direct)] ? light_constants(in.lists) : std::vector<SpecConstant>{});
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
  commands.begin_picture(colors, out.drawn.depth);
  record_batches(commands, in.scene, in.draws, in.deformed, out.drawn.pipelines,
                 in.wanted[size_t(Layer::direct)] ? &in.lists : nullptr);
  commands.end_rendering();
}

}  // namespace candela
