#include "passes/transparency/colored_shadows.h"

#include "shared/draw.h"

namespace candela {
namespace {

constexpr VkFormat shadow_format = VK_FORMAT_R16G16B16A16_SFLOAT;

bool is_seen_through(const DrawBatch& r) { return !r.solid() && r.topology == Topology::triangles; }
bool is_blended(const DrawBatch& r) { return is_seen_through(r) && !r.refracts; }
bool is_glass(const DrawBatch& r) { return is_seen_through(r) && r.refracts; }

// Whether some view of the layer draws glass.
bool has_glass(const ColoredShadows::In& in, uint32_t layer) {
  const std::vector<DrawBatch>& runs = *in.scene.draw_batches;
  const std::vector<uint32_t>& first = *in.draws.first_command;
  for (size_t v = 0; v < in.image->views.size(); ++v)
    for (size_t r = 0; r < runs.size(); ++r) {
      const size_t region = v * runs.size() + r;
      if (in.image->views[v].layer == layer && is_glass(runs[r]) && first[region] < first[region + 1]) return true;
    }
  return false;
}

// The direction to a parallel view's light, and 0; or where the light is, and how far it reaches.
glm::vec4 light_of(const shared::View& view) {
  const glm::dmat4 rows = glm::transpose(glm::dmat4(view.clip_from_relative));
  if (!(view.flags & shared::view_is_perspective)) return {glm::normalize(glm::dvec3(rows[2])), 0};
  const glm::dmat3 across = glm::transpose(glm::dmat3(rows[0], rows[1], rows[3]));
  const glm::dvec3 at = glm::inverse(across) * -glm::dvec3(rows[0].w, rows[1].w, rows[3].w);
  const glm::dvec4 end(view.planes[4]);  // faces the light; none: it reaches everywhere
  const double reach_m = glm::dot(glm::dvec3(end), at) + end.w;
  return {at, end == glm::dvec4(0) || !(reach_m > 0) ? 3e38 : reach_m};
}

}  // namespace

std::span<const Knob> ColoredShadowKnobs::table() {
  static const Knob table[] = {
      {.name = "scale",
       .member = &ColoredShadowKnobs::scale,
       .lowest = off,
       .highest = full,
       .levels = {off, half, half, full},
       .description =
           "texels along a side of what see-through surfaces leave of a light, over those of its shadow map; off: they "
           "let all of it through. Exact end: full, with sun.size_px and local.size_px as large as fit",
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
  out.straight = declare_batches(builder, s, in.draws, in.deformed, is_blended, choice);
  choice.desc.vertex_shader = "colored_shadows.vert#GLASS=1";
  choice.desc.fragment_shader = bends ? "colored_shadows.frag#GLASS=1#BODIES_BLOCK=1" : "colored_shadows.frag#GLASS=1";
  const BatchPipelines glass = declare_batches(builder, s, in.draws, in.deformed, is_glass, choice);
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
    out.back_faces = declare_batches(builder, s, in.draws, in.deformed, is_glass, choice);
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
    out.bodies = declare_batches(builder, s, in.draws, in.deformed, is_glass, {drawn, {}});
    write(out.colors, Access::color_attachment, ImageRange::layer(maps.layers + layer));
  }
  return out;
}

void ColoredShadows::record(CommandList& commands, const In& in, const Out& out) const {
  const std::vector<shared::View>& views = in.image->views;
  const uint32_t step = commands.step();
  const float scale = float(commands.size(out.colors).x) / float(in.image->size_px);
  shared::ColoredShadowPush push{};
  push.deformed = in.deformed ? commands.address(in.deformed) : 0;
  push.size_px = commands.size(out.colors).x;
  const auto draw_layer = [&](uint32_t layer, const BatchPipelines& pipelines) {
    for (uint32_t v = 0; v < views.size(); ++v) {
      const shared::View& view = views[v];
      if (view.layer != layer) continue;
      const glm::vec2 corner = glm::vec2(view.origin_px) * scale, size = glm::vec2(view.size_px) * scale;
      commands.set_viewport(corner, size);
      commands.set_scissor(glm::uvec2(corner), glm::uvec2(glm::ceil(size)));
      push.clip_from_relative = view.clip_from_relative;
      push.light = light_of(view);
      push.layer = layer | (view.flags & shared::view_is_perspective ? 0u : 1u << 31);
      push.place = glm::vec4(0.5f * size, corner + 0.5f * size) / float(push.size_px);
      record_view_runs(commands, in.scene, in.draws, pipelines, v, push);
    }
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
