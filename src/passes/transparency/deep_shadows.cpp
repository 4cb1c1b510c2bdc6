#include "passes/transparency/deep_shadows.h"

#include "passes/shared/light_view.h"

namespace candela {
namespace {

ImageRange first_layers(uint32_t count) { return {0, 1, 0, count}; }

}  // namespace

std::span<const Knob> DeepShadowKnobs::table() {
  static const Knob table[] = {
      {.name = "scale",
       .member = &DeepShadowKnobs::scale,
       .lowest = off,
       .highest = full,
       .levels = {off, quarter, quarter, half},
       .description = "size of the maps of coloured light by distance, which light blended surfaces and air, relative "
                      "to the shadow map; off: they are lit as if nothing blended stood in the way",
       .choices = {"off", "quarter", "half", "full"},
       .sweep = {off, quarter, half}},
      {.name = "slices",
       .member = &DeepShadowKnobs::slices,
       .lowest = 4,
       .highest = 24,
       .levels = {4, 8, 16, 24},
       .description = "distances kept in each texel of those maps, between its nearest and its farthest see-through "
                      "surface; memory and time grow with them",
       .sweep = {4, 8, 16, 24},
       .only = {4, 8, 12, 16, 20, 24}},
  };
  return table;
}

Need DeepShadows::needed(const SceneFacts& facts, const FrameRequest& request) const {
  if (facts.blend_items + facts.refracting_items == 0) return {false, "the scene has no surface that is seen through"};
  if (facts.blend_lit_items + facts.refracting_items == 0 && !request.draws_fog() && !request.draws_volumetric())
    return {false, "no blended surface takes light, and no air"};
  return needed_if(knobs.scale != Knobs::off, "deep_shadows.scale is off");
}

DeepShadows::Out DeepShadows::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  const ViewImage& maps = *in.image;
  const uint32_t texels = 1u << (Knobs::full - knobs.scale);  // of the maps, along a side of one
  ImageDesc desc{"deep_shadows." + maps.name, color_format};
  desc.width_px = desc.height_px = (maps.size_px + texels - 1) / texels;
  desc.kind = ImageKind::d2_array;
  const uint32_t slice_layers = uint32_t(knobs.slices) / 4;
  desc.layers = maps.layers * (2 + slice_layers);
  Out out;
  out.deep = builder.create(desc);
  const auto write = [&](uint32_t first, uint32_t count) {
    for (uint32_t layer = first * maps.layers; layer < (first + count) * maps.layers; ++layer)
      out.deep = builder.write(out.deep, Access::color_attachment, ImageRange::layer(layer));
  };
  const auto declare_seen_through = [&](const std::string& part, BatchPipelineChoice choice) {
    choice.desc.vertex_shader = "colored_shadows.vert";
    choice.desc.fragment_shader = "deep_shadows.frag" + part;
    BatchPipelines all = declare_batches(builder, s, in.draws, in.deformed, is_blended_to_light, choice);
    choice.desc.vertex_shader += "#GLASS=1", choice.desc.fragment_shader += "#GLASS=1";
    const BatchPipelines glass = declare_batches(builder, s, in.draws, in.deformed, is_glass_to_light, choice);
    for (size_t r = 0; r < glass.by_run.size(); ++r)
      if (glass.by_run[r]) all.by_run[r] = glass.by_run[r];
    return all;
  };

  builder.begin_step();
  builder.read(in.depth, Access::sampled_graphics, "the shadow maps");
  BatchPipelineChoice choice;
  choice.desc.color_formats = {color_format};
  choice.desc.blend = Blend::greatest;
  out.ranges = declare_seen_through("", choice);
  write(0, 1);

  builder.begin_step();
  builder.read(in.depth, Access::sampled_graphics, "the shadow maps");
  builder.read(out.deep, Access::sampled_graphics, "ranges", first_layers(maps.layers), ImageKind::d2_array);
  choice.desc.color_formats.assign(1 + slice_layers, color_format);
  choice.desc.blend = Blend::additive;
  out.sums = declare_seen_through(fmt::format("#SLICES={}", knobs.slices), choice);
  write(1, 1 + slice_layers);
  return out;
}

void DeepShadows::record(CommandList& commands, const In& in, const Out& out) const {
  const uint32_t layers = in.image->layers, groups = 2 + uint32_t(knobs.slices) / 4;
  const bool sums = commands.step() == 1;
  shared::ColoredShadowPush push = light_view_push(commands, in.deformed, commands.size(out.deep).x);
  push.images = commands.sampled(in.depth);
  if (sums) push.images |= commands.sampled(out.deep, first_layers(layers), ImageKind::d2_array) << 8;
  for (uint32_t layer = 0; layer < layers; ++layer) {
    std::vector<CommandList::Attachment> colors;
    for (uint32_t group = sums ? 1 : 0; group < (sums ? groups : 1); ++group)
      colors.push_back({.image = out.deep, .range = ImageRange::layer(group * layers + layer)});
    commands.begin_rendering(colors, {});
    draw_light_views(commands, in.scene, in.draws, sums ? out.sums : out.ranges, *in.image, layer, push);
    commands.end_rendering();
  }
}

}  // namespace candela
