#include "passes/transparency/phenomenological.h"

#include <array>
#include <bit>

#include "passes/shared/seen_through.h"
#include "shared/refraction.h"
#include "shared/transparency.h"

namespace candela {
std::span<const Knob> Phenomenological::Knobs::table() {
  static const Knob table[] = {
      {.name = "taps",
       .member = &Knobs::taps,
       .lowest = 1,
       .highest = 1024,
       .levels = {1, 8, 16, 128},
       .description = "lookups of the picture averaged for a pixel of frosted glass; 1: one lookup in a blurred level, "
                      "however close to the glass lies what it shows",
       .sweep = {1, 4, 8, 16, 32, 128}},
      {.name = "search",
       .member = &Knobs::search,
       .lowest = 0,
       .highest = 16,
       .levels = {1, 2, 4, 8},
       .description = "steps of the search for what a bent ray meets in the picture; 0: nothing is moved",
       .sweep = {0, 1, 2, 4, 8}},
      {.name = "backs",
       .member = &Knobs::backs,
       .lowest = 0,
       .highest = 8,
       .levels = {0, 2, 3, 8},
       .description =
           "steps of the search for a body's other side among the nearest back faces; 0: a body is a slab of the "
           "file's thickness",
       .sweep = {0, 1, 2, 3, 8}},
      {.name = "falloff",
       .member = &Knobs::falloff,
       .lowest = 0,
       .highest = 16,
       .description = "the farthest surface's own light counts 2 to this power times less than the nearest's; the best "
                      "value depends on how much the surfaces hide",
       .kind = Trades::look},
  };
  return table;
}

Need Phenomenological::needed(const SceneFacts& facts, const FrameRequest& request) const {
  if (facts.refracting_items == 0 || request.transparency != method) return needs_method(facts, request, method);
  return {};
}

Phenomenological::Out Phenomenological::declare(GraphBuilder& builder, const In& all) const {
  const BlendedIn& in = all.blended;
  const SceneInputs& s = in.scene;
  const bool glass = bool(all.picture), backs = glass && knobs.backs > 0;
  const auto image = [&](const char* name, uint32_t samples) {
    return builder.create(ImageDesc{name, color_format, s.width_px, s.height_px, samples});
  };
  const auto write = [&](ImageHandle& written) { written = builder.write(written, Access::color_attachment); };
  const auto refracts = [](const DrawBatch& r) { return r.refracts; };
  Out out;
  if (glass) {
    out.pipelines.down = builder.pipeline(ComputePipelineDesc{"refraction_down.comp", {}});
    out.backs.pyramid = declare_pyramid(builder, s, all.picture, "phenomenological.pyramid");
  }
  if (backs) {
    builder.begin_step();
    BatchPipelineChoice choice;
    choice.desc.vertex_shader = "draw.vert";
    choice.desc.fragment_shader = "phenomenological_backs.frag#BACKS=0";
    choice.desc.color_formats = {color_format};
    test_depth(choice.desc, true);
    choice.desc.depth_write = true;
    out.back_faces = declare_batches(builder, s, in.draws, in.deformed, refracts, choice);
    out.backs.faces = image("phenomenological.backs", 1);
    write(out.backs.faces);
    out.backs.z = builder.create(ImageDesc{"phenomenological.backs_z", depth_format, s.width_px, s.height_px});
    out.backs.z = builder.write(out.backs.z, Access::depth_attachment);
  }

  builder.begin_step();
  GraphicsPipelineDesc drawn;
  drawn.color_formats = {color_format, color_format};
  drawn.blend = Blend::additive;
  if (glass) {
    drawn.color_formats.insert(drawn.color_formats.end(), 2, color_format);
  }
  const std::string define = fmt::format("#SUMMED={}", knobs.falloff);
  std::string part;
  if (builder.read_optional(in.glass, Access::sampled_fragment)) {
    part = fmt::format("#{}={}", behind ? "BEHIND" : "BEFORE", s.samples);
    if (behind) part += builder.read_optional(in.depth, Access::sampled_fragment) ? "#BESIDE=1" : "#BESIDE=0";
  }
  out.drawn = declare_blended(builder, in, drawn, define + part + (glass ? "#BESIDE_GLASS=1" : ""));
  if (glass) {
    builder.read_optional(out.backs.faces, Access::sampled_fragment);
    drawn.vertex_shader = "draw.vert#GLASS=1";
    drawn.fragment_shader =
        with_fog("shade_forward.frag" + define + fmt::format("#GLASS=1#BACKS={}", backs ? 1 : 0), in.lists);
    drawn.fragment_shader = with_deep_shadows(drawn.fragment_shader, in.lists);
    drawn.samples = s.samples;
    test_depth(drawn, bool(in.depth));
    drawn.constants = light_constants(in.lists);
    if (backs) drawn.constants.push_back({42, "GLASS_SEARCH", uint32_t(knobs.backs)});
    const BatchPipelines glasses = declare_batches(builder, s, in.draws, in.deformed, refracts, {drawn, {}});
    for (size_t r = 0; r < glasses.by_run.size(); ++r)
      if (glasses.by_run[r]) out.drawn.by_run[r] = glasses.by_run[r];
  }
  const auto sums = [&](ImageHandle& made, const char* name) {
    made = image(name, s.samples);
    write(made);
  };
  sums(out.sums.light, "phenomenological.sum");
  sums(out.sums.absorbed, "phenomenological.absorbed");
  if (glass) {
    sums(out.sums.widths, "phenomenological.widths");
    sums(out.sums.moved, "phenomenological.moved");
  }

  builder.begin_step();
  builder.read(in.color, Access::sampled_fragment, "what is behind");
  for (const ImageHandle sum : {out.sums.light, out.sums.absorbed}) builder.read(sum, Access::sampled_fragment, "sums");
  GraphicsPipelineDesc over;
  over.vertex_shader = "background.vert", over.fragment_shader = "phenomenological_over.frag";
  over.constants = {{0, "SAMPLES", s.samples}};
  over.color_formats = {color_format};
  over.samples = s.samples;
  if (glass) {
    builder.read(s.constants, Access::uniform_read, "the frame's constants");
    for (const ImageHandle sum : {out.sums.widths, out.sums.moved})
      builder.read(sum, Access::sampled_fragment, "how glass moves and blurs");
    if (all.picture.resource != in.color.resource)
      builder.read(all.picture, Access::sampled_fragment, "the picture behind");
    builder.read(out.backs.pyramid, Access::sampled_fragment, "the picture's levels");
    const bool opaque = builder.read_optional(in.depth, Access::sampled_fragment);
    over.fragment_shader += fmt::format("#REFRACTION={}", opaque ? 2 : 1);
    if (s.samples > 1) over.constants.push_back({41, "REFRACTION_DEPTH_SAMPLES", s.samples});
    over.constants.push_back({43, "TAPS", uint32_t(knobs.taps)});
    over.constants.push_back({44, "SEARCH", uint32_t(knobs.search)});
  }
  out.pipelines.over = builder.pipeline(over);
  ImageDesc color{"phenomenological.color", color_format, s.width_px, s.height_px, s.samples};
  color.covered = true;
  out.color = builder.write(builder.create(color), Access::color_attachment);
  return out;
}

void Phenomenological::record(CommandList& commands, const In& all, const Out& out) const {
  const BlendedIn& in = all.blended;
  const SceneInputs& s = in.scene;
  const bool glass = bool(all.picture);
  const uint32_t levels = glass ? pyramid_levels(s) : 0, draw_step = levels + (out.backs.faces ? 1 : 0);
  const uint32_t step = commands.step();
  if (step < levels) {
    record_level(commands, out.pipelines.down, all.picture, out.backs.pyramid, {s.width_px, s.height_px}, step);
    return;
  }
  OwnInputs own;
  if (step < draw_step) {
    const CommandList::Attachment backs{out.backs.faces};
    commands.begin_picture({&backs, 1}, out.backs.z);
    own.backs = true;
    record_batches(commands, s, in.draws, in.deformed, out.back_faces, nullptr, nullptr, own);
  } else if (step == draw_step) {
    std::vector<CommandList::Attachment> sums = {{out.sums.light}, {out.sums.absorbed}};
    if (glass) sums.insert(sums.end(), {{out.sums.widths}, {out.sums.moved}});
    commands.begin_picture(sums, in.depth);
    own.word = std::bit_cast<uint64_t>(std::array{s.values->blended_near_m, s.values->blended_far_m});
    if (in.glass) own.number = commands.sampled(in.glass);
    if (in.glass && behind && in.depth) own.number |= commands.sampled(in.depth) << 8;
    if (out.backs.faces) own.number |= commands.sampled(out.backs.faces) << 16;
    record_batches(commands, s, in.draws, in.deformed, out.drawn, &in.lists, &in.lists, own);
  } else {
    shared::PhenomenologicalPush push{};
    push.sum = commands.sampled(out.sums.light), push.covered = commands.sampled(out.sums.absorbed);
    push.color = commands.sampled(in.color);
    if (glass) {
      push.widths = commands.sampled(out.sums.widths), push.moved = commands.sampled(out.sums.moved);
      push.images = REFRACTION_IMAGES(commands.sampled(all.picture), commands.sampled(out.backs.pyramid),
                                      in.depth ? commands.sampled(in.depth) : 0u, 0u);
    }
    const CommandList::Attachment color{out.color};
    commands.begin_picture({&color, 1}, {});
    commands.bind(out.pipelines.over);
    draw_samples(commands, s.samples, push);
  }
  commands.end_rendering();
}

}  // namespace candela
