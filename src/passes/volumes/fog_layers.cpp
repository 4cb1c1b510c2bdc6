#include "passes/volumes/fog_layers.h"

#include "shared/draw.h"

namespace candela {

Need FogLayers::needed(const SceneFacts&, const FrameRequest& request) const {
  if (!request.look.fog) return {false, "the look has no fog (--look)"};
  if (!request.draws_fog()) return {false, "fog is not wanted (--effects)"};
  for (const LayerName& layer : layers)
    if (request.has_layer(layer.name)) return {};
  return {false, "no layer of fog is wanted (--layers)"};
}

FogLayers::Out FogLayers::declare(GraphBuilder& builder, const In& in) const {
  const bool tested = bool(in.depth);
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  Out out;
  std::string wanted;
  std::vector<VkFormat> formats;
  static constexpr const char* defines[] = {"LIGHT", "TRANSMITTANCE"};
  Lighting lists = in.lists;
  if (!in.wanted[0]) lists.fog.light = FogLight::nothing;  // transmittance alone looks no light up
  for (size_t i = 0; i < 2; ++i) {
    if (!in.wanted[i]) continue;
    wanted += fmt::format("#{}={}", defines[i], formats.size());
    formats.push_back(color_format);
  }
  declare_fog(builder, in.scene, lists);
  GraphicsPipelineDesc behind;
  behind.vertex_shader = "background.vert";
  Lighting far = lists;
  far.fog.last = 0;
  behind.fragment_shader = with_fog("fog_layers_sky.frag" + wanted, far);
  behind.color_formats = formats;
  behind.depth_format = tested ? depth_format : VK_FORMAT_UNDEFINED;
  behind.samples = in.scene.samples;
  behind.depth_test = tested;
  behind.depth_compare = VK_COMPARE_OP_EQUAL;
  out.behind = builder.pipeline(behind);
  BatchPipelineChoice choice;
  choice.desc = behind;
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.fragment_shader = with_fog("fog_layers.frag" + wanted, lists);
  if (!in.scene.draw_batches->empty()) {
    out.opaque = declare_batches(
        builder, in.scene, in.draws, in.deformed, [](const DrawBatch& r) { return r.solid(); }, choice);
    declare_fog(builder, in.scene, of_blended(lists));
    choice.desc.fragment_shader = with_fog("fog_layers.frag" + wanted, of_blended(lists));
    if (in.nearest) choice.desc.depth_format = depth_format, choice.desc.depth_test = true;
    choice.desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
    choice.desc.blend = Blend::premultiplied_over;
    // Surfaces that let light through cover all, and come first.
    const auto is_drawn = [&](const DrawBatch& r) { return !r.solid() && (r.refracts || !in.without_blended); };
    out.blended = declare_batches(builder, in.scene, in.draws, in.deformed, is_drawn, choice);
  }
  for (size_t i = 0; i < 2; ++i) {
    if (!in.wanted[i]) continue;
    ImageDesc desc{std::string(layers[i].name) + ".layer", color_format, in.scene.width_px, in.scene.height_px,
                   in.scene.samples};
    desc.covered = true;
    out.images[i] = builder.create(desc);
  }
  const auto write = [&](ImageHandle depth) {
    if (in.nearest) builder.begin_step();
    builder.read_optional(depth, Access::depth_test);
    for (ImageHandle& image : out.images)
      if (image) image = builder.write(image, Access::color_attachment);
  };
  write(in.depth);
  if (in.nearest) write(in.nearest);  // as beauty does (passes/surfaces/terms.cpp)
  return out;
}

void FogLayers::record(CommandList& commands, const In& in, const Out& out) const {
  Lighting lists = in.lists;
  if (!in.wanted[0]) lists.fog.light = FogLight::nothing;
  std::vector<CommandList::Attachment> colors;
  for (const ImageHandle image : out.images)
    if (image) colors.push_back({image});
  const bool first = commands.step() == 0, last = !in.nearest || !first;
  commands.begin_picture(colors, first ? in.depth : in.nearest);
  if (first) {
    commands.bind(out.behind);
    commands.push(sky_push(commands, in.scene, lists));
    commands.set_cull(false, false);
    commands.draw(3);
  }
  if (!in.scene.draw_batches->empty()) {
    BatchPipelines all = out.opaque;
    if (!first) all.by_run.assign(all.by_run.size(), {});
    for (size_t r = 0; r < all.by_run.size() && last; ++r)
      if (out.blended.by_run[r]) all.by_run[r] = out.blended.by_run[r];
    record_batches(commands, in.scene, in.draws, in.deformed, all, fog_walks(of_blended(lists)) ? &lists : nullptr,
                   &lists);
  }
  commands.end_rendering();
}

}  // namespace candela
