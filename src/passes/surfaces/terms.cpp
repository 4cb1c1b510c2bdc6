#include "passes/surfaces/terms.h"

#include <algorithm>

namespace candela {
namespace {

bool wants_lighting(const Terms::In& in) {
  return in.groups > 0 || in.wanted[size_t(Term::direct_sun)] || in.wanted[size_t(Term::direct_point)] ||
         in.wanted[size_t(Term::direct_spot)] ||
         ((in.lists.occlusion.open || in.lists.occlusion.traced) &&
          (in.wanted[size_t(Term::ambient_diffuse)] || in.wanted[size_t(Term::ambient_specular)]));
}

// Terms are what fog leaves of them; its own light is none of them.
Lighting transmitted(Lighting lists) {
  if (lists.fog) lists.fog.light = FogLight::nothing;
  return lists;
}

bool shows_reflected(const Terms::In& in) {
  return in.reflected.light && (in.wanted[size_t(Term::ambient_specular)] || in.wanted[size_t(Term::reflections)]);
}

// "direct_sun" is DIRECT_SUN in the shader.
std::string define_of(std::string_view layer) {
  std::string define(layer);
  for (char& c : define) c = c == '.' ? '_' : char(std::toupper(static_cast<unsigned char>(c)));
  return define;
}

}  // namespace

Need Terms::needed(const SceneFacts&, const FrameRequest& request) const {
  if (of_lights) return needed_if(!request.light_groups.empty(), "no group of lights is wanted (--light-groups)");
  for (const LayerName& layer : layers)
    if (request.wants_term(layer.name)) return {};
  return {false, "no term of beauty is wanted (--layers)"};
}

std::string Terms::stored_part(size_t term) {
  std::string output(layers[term].name);
  std::replace(output.begin(), output.end(), '.', '_');
  return fmt::format("terms.frag#{}=0#TERM=out_{}", define_of(layers[term].name), output);
}

std::string Terms::stored_group(uint32_t group) {
  return fmt::format("terms.frag#LIGHT_GROUPS=1#FIRST_GROUP={}#TERM=out_groups[0]", group);
}

Terms::Out Terms::declare(GraphBuilder& builder, const In& in) const {
  const bool tested = bool(in.depth);
  BatchPipelineChoice choice;
  if (wants_lighting(in)) {
    declare_lights(builder, in.scene, in.lists);
    choice.desc.constants = light_constants(in.lists);
  }
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.fragment_shader = "terms.frag";
  for (uint32_t i = 0; i < term_count; ++i) {
    if (!in.wanted[i]) continue;
    choice.desc.fragment_shader += fmt::format("#{}={}", define_of(layers[i].name), choice.desc.color_formats.size());
    choice.desc.color_formats.push_back(color_format);
  }
  if (in.groups > 0) {
    choice.desc.fragment_shader += fmt::format("#LIGHT_GROUPS={}#FIRST_GROUP={}", in.groups, in.first_group);
    choice.desc.color_formats.assign(in.groups, color_format);
  }
  const std::string shader = choice.desc.fragment_shader;
  const ShadowColors colors = wants_lighting(in) ? in.lists.shadow_colors : ShadowColors{};
  choice.desc.fragment_shader = with_shadow_colors(with_fog(shader, transmitted(in.lists)), colors);
  choice.desc.depth_format = tested ? depth_format : VK_FORMAT_UNDEFINED;
  choice.desc.samples = in.scene.samples;
  choice.desc.depth_test = tested;
  choice.desc.depth_compare = VK_COMPARE_OP_EQUAL;
  Out out;
  if (shows_reflected(in)) {
    std::string terms;
    for (const Term term : {Term::ambient_specular, Term::reflections})
      if (in.wanted[size_t(term)])
        terms += fmt::format("#{}={}", define_of(layers[size_t(term)].name),
                             std::count(in.wanted.begin(), in.wanted.begin() + size_t(term), true));
    out.reflected =
        declare_reflected(builder, in.scene, in.reflected, in.depth, choice.desc.color_formats, tested, terms);
  }
  out.opaque = declare_batches(
      builder, in.scene, in.draws, in.deformed, [](const DrawBatch& r) { return r.solid(); }, choice);
  if (wants_lighting(in)) {
    Lighting unoccluded = in.lists;
    unoccluded.occlusion = {};
    choice.desc.constants = light_constants(unoccluded);
  }
  const auto seen_through = [&](std::string all) {
    return wants_lighting(in) ? with_deep_shadows(std::move(all), in.lists) : all;
  };
  choice.desc.fragment_shader = seen_through(with_fog(shader, transmitted(in.lists)));
  if (in.seen) {
    choice.desc.depth_format = depth_format;
    choice.desc.depth_test = true;
    BatchPipelineChoice refracting = choice;
    declare_fog(builder, in.scene, of_blended(in.lists), wants_lighting(in));
    refracting.desc.fragment_shader = seen_through(with_fog(shader, of_blended(in.lists)));
    declare_seen_through(builder, in.scene, in.seen, refracting);
    out.refracting = declare_batches(
        builder, in.scene, in.draws, in.deformed, [](const DrawBatch& r) { return r.refracts; }, refracting);
  }
  choice.desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  choice.desc.blend = Blend::premultiplied_over;
  const auto is_blended = [&](const DrawBatch& r) { return r.alpha == AlphaMode::blend && !in.without_blended; };
  out.blended = declare_batches(builder, in.scene, in.draws, in.deformed, is_blended, choice);
  const auto image = [&](const std::string& of) {
    return builder.create(
        ImageDesc{"terms." + of, color_format, in.scene.width_px, in.scene.height_px, in.scene.samples});
  };
  for (uint32_t i = 0; i < in.groups; ++i) out.images[i] = image(fmt::format("group{}", in.first_group + i));
  for (uint32_t i = 0; i < term_count; ++i) {
    if (!in.wanted[i]) continue;
    out.images[i] = Term(i) == Term::background ? in.background : ImageHandle{};
    if (!out.images[i]) out.images[i] = image(std::string(layers[i].name));
  }
  const auto write = [&](ImageHandle depth) {
    if (in.seen) builder.begin_step();
    builder.read_optional(depth, Access::depth_test);
    for (ImageHandle& image : out.images)
      if (image) image = builder.write(image, Access::color_attachment);
  };
  write(in.depth);
  // Against another depth: where an opaque surface is seen beside glass it is shaded where beauty shades it, at the
  // middle of the samples that are its own without the glass.
  if (in.seen) write(in.nearest);
  return out;
}

void Terms::record(CommandList& commands, const In& in, const Out& out) const {
  std::vector<CommandList::Attachment> colors;
  for (const ImageHandle image : out.images)
    if (image) colors.push_back({image});
  const Lighting* const lists = wants_lighting(in) ? &in.lists : nullptr;
  const Lighting seen_fog = in.seen ? of_blended(in.lists) : Lighting{};
  const Lighting* const fog = in.seen ? &seen_fog : nullptr;
  const OwnInputs own = in.seen ? own_inputs(commands, in.seen) : OwnInputs{};
  const auto draw = [&](const BatchPipelines& runs) {
    record_batches(commands, in.scene, in.draws, in.deformed, runs, lists, fog, own);
  };
  // Blended runs come after the others in the order of drawing.
  const auto with = [](BatchPipelines runs, const BatchPipelines& more) {
    for (size_t r = 0; r < more.by_run.size(); ++r)
      if (more.by_run[r]) runs.by_run[r] = more.by_run[r];
    return runs;
  };
  const bool beside_glass = in.seen && commands.step() == 0, glass = in.seen && !beside_glass;
  commands.begin_picture(colors, glass ? in.nearest : in.depth);
  if (glass) {
    draw(with(out.refracting, out.blended));
  } else if (out.reflected || beside_glass) {
    draw(out.opaque);
    if (out.reflected) record_reflected(commands, in.scene, in.reflected, in.depth, out.reflected);
    if (!beside_glass) draw(out.blended);
  } else {
    draw(with(out.opaque, out.blended));
  }
  commands.end_rendering();
}

}  // namespace candela
