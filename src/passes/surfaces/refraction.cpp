#include "passes/surfaces/refraction.h"

#include <bit>

#include "passes/shared/blended.h"
#include "passes/shared/features.h"
#include "shared/refraction.h"

namespace candela {

std::span<const Knob> RefractionKnobs::table() {
  static const Knob table[] = {
      screen_or_rays_row<RefractionKnobs>(
          "what is seen through smooth surfaces: the picture behind a slab, or what a ray through the bodies "
          "themselves meets"),
      {.name = "samples",
       .member = &RefractionKnobs::samples,
       .lowest = 0,
       .highest = 1024,
       .levels = {0, 4, 8, 64},
       .description =
           "directions through a rough surface, each followed to the depth seen there; fewer leave copies of what is "
           "behind; 0: one look-up, blurred by roughness and index alone, however far what is behind lies",
       .sweep = {0, 1, 4, 8, 16, 64}},
      {.name = "walls",
       .member = &RefractionKnobs::walls,
       .lowest = 1,
       .highest = 1024,
       .levels = {4, 8, 8, 64},
       .description = "walls of bodies that bend or reflect a ray; through those after them it goes straight",
       .sweep = {1, 2, 4, 8, 16, 64},
       .required = "refraction.method=traced"},
      {.name = "backs",
       .member = &RefractionKnobs::backs,
       .lowest = 0,
       .highest = 16,
       .levels = {0, 2, 3, 8},
       .description =
           "steps of the search for a body's other side among the nearest back faces, by which, and by all faces "
           "behind, it absorbs; 0: a body is a slab of the file's thickness",
       .sweep = {0, 1, 2, 3, 8}},
      {.name = "roughest",
       .member = &RefractionKnobs::roughest,
       .lowest = 0,
       .highest = 1,
       .levels = {0.2, 0.1, 0.1, 0.045},
       .description = "roughness from which method traced looks up the picture instead; a higher value treats rough "
                      "surfaces as smooth",
       .sweep = {0.4, 0.2, 0.1, 0.045},
       .required = "refraction.method=traced"},
      {.name = "full_size",
       .member = &RefractionKnobs::full_size,
       .lowest = 0,
       .highest = 1,
       .levels = {1},
       .description = "1: smooth surfaces look up the picture behind them at full size; 0: in a copy of the next lower "
                      "power of two, which saves an image of the picture's size",
       .sweep = {0, 1}},
  };
  return table;
}

Need Refraction::needed(const SceneFacts& facts, const FrameRequest& request) const {
  if (!request.wants_true(effect)) return {false, "refraction is not wanted (--effects, --quality)"};
  if (request.transparency == method_with_glass)
    return {false, "--transparency phenomenological draws what refracts together with blended surfaces"};
  return needed_if(facts.refracting_items > 0, "the scene has no surface that refracts");
}

bool Refraction::ignores(std::string_view knob) const {
  if (knob == "full_size") return knobs.full_size != 0;  // what is always there is no choice of the plan's
  return knobs.method == Knobs::screen && (knob == "walls" || knob == "roughest");
}

void Refraction::declare_rays(GraphBuilder& builder, const In& in, Out& out) const {
  const SceneInputs& s = in.scene;
  builder.begin_step();
  declare_met_surfaces(builder, s, in.deformed, in.met);
  ComputePipelineDesc desc{with_fog("refraction_rays.comp", in.met), met_constants(s, in.met)};
  desc.constants.push_back({43, "WALLS", uint32_t(knobs.walls)});
  if (in.shows_sky) desc.constants.push_back({44, "SHOWS_SKY", 1});
  desc.shader += surface_definitions(desc.constants);
  out.rays = builder.pipeline(desc);
  const ImageDesc image{"refraction.rays", color_format, s.width_px, s.height_px};
  out.seen.rays = builder.write(builder.create(image), Access::storage_image_write);
  out.seen.roughest = knobs.roughest;
}

void Refraction::record_rays(CommandList& commands, const In& in, const Out& out) const {
  OwnInputs own;
  own.word = REFRACTION_IMAGES(0u, 0u, 0u, commands.storage(out.seen.rays));
  own.number = std::bit_cast<uint32_t>(knobs.roughest);
  own.deformed_before = in.scene.drawn_items;
  commands.bind(out.rays);
  commands.push(draw_push(commands, in.scene, in.deformed, &in.met, &in.met, own));
  commands.dispatch_picture(in.scene.width_px, in.scene.height_px);
}

void Refraction::declare_bodies(GraphBuilder& builder, const In& in, Out& out) const {
  const SceneInputs& s = in.scene;
  builder.begin_step();
  BatchPipelineChoice choice;
  choice.desc.vertex_shader = "draw.vert#REFRACTION=1";
  if (s.samples > 1) choice.desc.constants = {{41, "REFRACTION_DEPTH_SAMPLES", s.samples}};
  builder.read_optional(in.behind, Access::sampled_fragment);
  const auto image = [&](const char* what, const char* part, VkFormat format, Blend blend, BatchPipelines& drawn) {
    choice.desc.fragment_shader = fmt::format("refraction_bodies.frag#REFRACTION={}{}", in.behind ? 2 : 1, part);
    choice.desc.color_formats = {format};
    choice.desc.blend = blend;
    drawn = declare_batches(
        builder, s, in.draws, in.deformed, [](const DrawBatch& r) { return r.refracts; }, choice);
    return builder.write(builder.create(ImageDesc{what, format, s.width_px, s.height_px}), Access::color_attachment);
  };
  out.seen.sums = image("refraction.sums", "", color_format, Blend::additive, out.sums);
  out.seen.backs = image("refraction.backs", "#NEAREST=1", float_format, Blend::greatest, out.nearest);
  out.seen.body_search = uint32_t(knobs.backs);
}

void Refraction::record_bodies(CommandList& commands, const In& in, const Out& out) const {
  const auto draw = [&](const BatchPipelines& pipelines, bool backs) {
    OwnInputs own;
    own.word = REFRACTION_IMAGES(0u, 0u, in.behind ? commands.sampled(in.behind) : 0u, 0u);
    own.number = backs ? 1 : 0;
    own.backs = backs;
    record_batches(commands, in.scene, in.draws, in.deformed, pipelines, nullptr, nullptr, own);
  };
  const CommandList::Attachment sums{out.seen.sums}, nearest{out.seen.backs};
  commands.begin_picture({&sums, 1}, {});
  for (const bool backs : {false, true}) draw(out.sums, backs);
  commands.end_rendering();
  commands.begin_picture({&nearest, 1}, {});
  draw(out.nearest, true);
  commands.end_rendering();
}

Refraction::Out Refraction::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& scene = in.scene;
  Out out;
  out.down = builder.pipeline(ComputePipelineDesc{"refraction_down.comp", {}});
  out.seen = {.picture = in.picture, .behind = in.behind, .lobe_samples = uint32_t(knobs.samples)};
  // Not the image that is drawn to.
  if (scene.samples == 1 && knobs.full_size != 0) {
    builder.begin_step();
    builder.read(in.picture, Access::sampled_compute, "the picture behind");
    out.seen.picture =
        builder.write(builder.create(ImageDesc{"refraction.copy", color_format, scene.width_px, scene.height_px}),
                      Access::storage_image_write);
  }
  out.seen.pyramid = declare_pyramid(builder, scene, out.seen.picture, "refraction.pyramid");
  if (knobs.full_size == 0) out.seen.picture = out.seen.pyramid;
  if (knobs.method == Knobs::by_rays) declare_rays(builder, in, out);
  if (in.bodies && knobs.backs > 0) declare_bodies(builder, in, out);
  builder.begin_step();
  builder.read(in.depth, Access::depth_test, "depth");
  declare_lights(builder, scene, in.lists);
  declare_fog(builder, scene, in.lists, true);
  BatchPipelineChoice choice;
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.fragment_shader = with_deep_shadows(with_fog("shade_forward.frag", in.lists), in.lists);
  choice.desc.color_formats = {color_format};
  choice.desc.depth_format = depth_format;
  choice.desc.samples = scene.samples;
  choice.desc.depth_test = true;
  choice.desc.depth_compare = VK_COMPARE_OP_EQUAL;
  choice.desc.constants = light_constants(in.lists);
  declare_seen_through(builder, scene, out.seen, choice);
  out.pipelines = declare_batches(
      builder, scene, in.draws, in.deformed, [](const DrawBatch& r) { return r.refracts; }, choice);
  out.color = builder.write(in.color, Access::color_attachment);
  return out;
}

void Refraction::record(CommandList& commands, const In& in, const Out& out) const {
  const glm::uvec2 size(in.scene.width_px, in.scene.height_px);
  const uint32_t copies = in.scene.samples == 1 && knobs.full_size != 0 ? 1 : 0, step = commands.step();
  if (step < copies) {
    commands.bind(out.down);
    commands.push(
        shared::RefractionDownPush{commands.sampled(in.picture), commands.storage(out.seen.picture), size, size});
    commands.dispatch(size.x, size.y);
    return;
  }
  if (step < copies + pyramid_levels(in.scene)) {
    record_level(commands, out.down, knobs.full_size != 0 ? out.seen.picture : in.picture, out.seen.pyramid, size,
                 step - copies);
    return;
  }
  uint32_t next = copies + pyramid_levels(in.scene);
  if (out.rays && next++ == step) {
    record_rays(commands, in, out);
    return;
  }
  if (out.seen.sums && step == next) {
    record_bodies(commands, in, out);
    return;
  }
  const CommandList::Attachment color{out.color};
  commands.begin_picture({&color, 1}, in.depth);
  record_batches(commands, in.scene, in.draws, in.deformed, out.pipelines, &in.lists, &in.lists,
                 own_inputs(commands, out.seen));
  commands.end_rendering();
}

}  // namespace candela
