#include "passes/transparency/colored_shadows.h"

#include "passes/shared/light_view.h"

namespace candela {
namespace {

// Halves round by 2^-11 of the light for each surface before it, which hundreds of nearly clear ones add up.
VkFormat format_of(const ColoredShadowKnobs& knobs) {
  return knobs.scale == ColoredShadowKnobs::full ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_R16G16B16A16_SFLOAT;
}

// Whether some view of the layer draws glass.
bool has_glass(const ColoredShadows::In& in, uint32_t layer) {
  const std::vector<DrawBatch>& runs = *in.scene.draw_batches;
  const std::vector<uint32_t>& first = *in.draws.first_command;
  for (size_t v = 0; v < in.image->views.size(); ++v)
    for (size_t r = 0; r < runs.size(); ++r) {
      const size_t region = v * runs.size() + r;
      if (in.image->views[v].layer == layer && is_glass_to_light(runs[r]) && first[region] < first[region + 1])
        return true;
    }
  return false;
}

}  // namespace

std::span<const Knob> ColoredShadowKnobs::table() {
  static const Knob table[] = {
      {.name = "scale",
       .member = &ColoredShadowKnobs::scale,
       .lowest = off,
       .highest = full,
       .levels = {off, half, half, full},
       .description = "size of the maps of light coloured by see-through surfaces, relative to the shadow map; off: "
                      "those surfaces let all light through. Exact end: full, in 32-bit floats, with sun.size_px and "
                      "local.size_px as large as fit",
       .choices = {"off", "half", "full"},
       .sweep = {off, half, full}},
      {.name = "steps",
       .member = &ColoredShadowKnobs::steps,
       .lowest = 0,
       .highest = 16,
       .levels = {0, 2, 3, 8},
       .description =
           "steps of the searches for a body's other side and for where the light that it bends lands; 0: bodies "
           "let light go straight on, as sheets do",
       .sweep = {0, 1, 2, 3, 8}},
  };
  return table;
}

Need ColoredShadows::needed(const SceneFacts& facts, const FrameRequest& request) const {
  if (facts.blend_items + facts.refracting_items == 0) return {false, "the scene has no surface that is seen through"};
  if (facts.lit_items == 0) return {false, "the scene has no opaque or masked surface that takes light"};
  return needed_if(knobs.scale != Knobs::off, "colored_shadows.scale is off");
}

ColoredShadows::Out ColoredShadows::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  const ViewImage& maps = *in.image;
  Out out;
  const bool bends = this->bends(in);
  const VkFormat shadow_format = format_of(knobs);
  ImageDesc desc{"colored_shadows." + maps.name, shadow_format};
  desc.width_px = desc.height_px = knobs.scale == Knobs::full ? maps.size_px : (maps.size_px + 1) / 2;
  desc.kind = ImageKind::d2_array;
  desc.layers = bends ? 2 * maps.layers : maps.layers;
  out.colors = builder.create(desc);
  const auto write = [&](ImageHandle& image, Access access, ImageRange range = {}) {
    image = builder.write(image, access, range);
  };

  builder.begin_step();
  builder.read(in.depth, Access::sampled_graphics, "the shadow maps");
  BatchPipelineChoice choice;
  choice.desc.vertex_shader = "colored_shadows.vert";
  choice.desc.fragment_shader = "colored_shadows.frag";
  choice.desc.color_formats = {shadow_format};
  choice.desc.blend = Blend::coverage;
  out.straight = declare_batches(builder, s, in.draws, in.deformed, is_blended_to_light, choice);
  choice.desc.vertex_shader = "colored_shadows.vert#GLASS=1";
  choice.desc.fragment_shader = bends ? "colored_shadows.frag#GLASS=1#BODIES_BLOCK=1" : "colored_shadows.frag#GLASS=1";
  const BatchPipelines glass = declare_batches(builder, s, in.draws, in.deformed, is_glass_to_light, choice);
  for (size_t r = 0; r < glass.by_run.size(); ++r)
    if (glass.by_run[r]) out.straight.by_run[r] = glass.by_run[r];
  for (uint32_t layer = 0; layer < desc.layers; ++layer)
    write(out.colors, Access::color_attachment, ImageRange::layer(layer));

  for (uint32_t layer = 0; bends && layer < maps.layers; ++layer) {
    if (!has_glass(in, layer)) continue;
    const auto image = [&](const char* what, VkFormat format) {
      return builder.create(
          ImageDesc{fmt::format("{}.{}.{}", desc.name, what, layer), format, desc.width_px, desc.height_px});
    };
    Bent& bent = out.bent.emplace_back(layer);
    builder.begin_step();
    choice.desc.fragment_shader = "colored_shadows_backs.frag#GLASS=1";
    choice.desc.color_formats = {color_format, shadow_format};
    choice.desc.blend = Blend::none;
    test_depth(choice.desc, true);
    choice.desc.depth_write = true;
    out.back_faces = declare_batches(builder, s, in.draws, in.deformed, is_glass_to_light, choice);
    bent.positions = image("back_positions", color_format);
    bent.normals = image("back_normals", shadow_format);
    bent.z = image("back_z", depth_format);
    for (ImageHandle* written : {&bent.positions, &bent.normals}) write(*written, Access::color_attachment);
    write(bent.z, Access::depth_attachment);

    builder.begin_step();
    for (const ImageHandle read : {bent.positions, bent.normals})
      builder.read(read, Access::sampled_graphics, "back faces");
    builder.read(in.depth, Access::sampled_graphics, "the shadow maps");
    GraphicsPipelineDesc drawn;
    drawn.vertex_shader = "colored_shadows.vert#GLASS=1#BENDS=1";
    drawn.fragment_shader = "colored_shadows.frag#GLASS=1#BENDS=1";
    drawn.color_formats = {shadow_format};
    drawn.blend = Blend::additive;
    drawn.constants = {{45, "STEPS", uint32_t(knobs.steps)}};
    out.bodies = declare_batches(builder, s, in.draws, in.deformed, is_glass_to_light, {drawn, {}});
    write(out.colors, Access::color_attachment, ImageRange::layer(maps.layers + layer));
  }
  return out;
}

void ColoredShadows::record(CommandList& commands, const In& in, const Out& out) const {
  const uint32_t step = commands.step();
  shared::ColoredShadowPush push = light_view_push(commands, in.deformed, commands.size(out.colors).x);
  const auto draw_layer = [&](uint32_t layer, const BatchPipelines& pipelines) {
    draw_light_views(commands, in.scene, in.draws, pipelines, *in.image, layer, push);
  };
  if (step == 0) {
    push.images = commands.sampled(in.depth);
    const uint32_t layers = in.image->layers;
    for (uint32_t layer = 0; layer < (bends(in) ? 2 * layers : layers); ++layer) {
      const CommandList::Attachment colors{.image = out.colors, .range = ImageRange::layer(layer)};
      commands.begin_rendering({&colors, 1}, {});
      if (layer < layers) draw_layer(layer, out.straight);
      commands.end_rendering();
    }
    return;
  }
  const Bent& bent = out.bent[(step - 1) / 2];
  if (step % 2 == 1) {
    const CommandList::Attachment backs[] = {{bent.positions}, {bent.normals}};
    commands.begin_rendering(backs, bent.z);
    draw_layer(bent.layer, out.back_faces);
  } else {
    push.images =
        commands.sampled(in.depth) | commands.sampled(bent.positions) << 8 | commands.sampled(bent.normals) << 16;
    const CommandList::Attachment colors{.image = out.colors,
                                         .range = ImageRange::layer(in.image->layers + bent.layer)};
    commands.begin_rendering({&colors, 1}, {});
    draw_layer(bent.layer, out.bodies);
  }
  commands.end_rendering();
}

}  // namespace candela
