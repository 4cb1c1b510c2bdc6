#include "passes/surfaces/terms.h"

#include <algorithm>

namespace candela {
namespace {

bool wants_lighting(const Terms::In& in) {
  return in.wanted[size_t(Term::direct_sun)] || in.wanted[size_t(Term::direct_point)] ||
         in.wanted[size_t(Term::direct_spot)] ||
         ((in.lists.occlusion.open || in.lists.occlusion.traced) &&
          (in.wanted[size_t(Term::ambient_diffuse)] || in.wanted[size_t(Term::ambient_specular)]));
}

// Terms are what fog leaves of them; its own light is none of them.
CellLists transmitted(CellLists lists) {
  if (lists.fog) lists.fog.light = FogLight::nothing;
  return lists;
}

bool shows_reflected(const Terms::In& in) {
  return in.reflected.light && (in.wanted[size_t(Term::ambient_specular)] || in.wanted[size_t(Term::reflections)]);
}

// "direct.sun" is DIRECT_SUN in the shader.
std::string define_of(std::string_view layer) {
  std::string define(layer);
  for (char& c : define) c = c == '.' ? '_' : char(std::toupper(static_cast<unsigned char>(c)));
  return define;
}

}  // namespace

Need Terms::needed(const SceneFacts&, const FrameRequest& request) const {
  for (const LayerName& layer : layers)
    if (request.wants_term(layer.name)) return {};
  return {false, "no term of beauty is wanted (--layers)"};
}

Terms::Out Terms::declare(GraphBuilder& builder, const In& in) const {
  const bool tested = builder.read_optional(in.depth, Access::depth_test);
  RunPipelineChoice choice;
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
  choice.desc.fragment_shader = with_fog(choice.desc.fragment_shader, transmitted(in.lists));
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
  out.opaque = declare_runs(
      builder, in.scene, in.draws, in.deformed, [](const DrawRun& r) { return r.solid(); }, choice);
  if (wants_lighting(in)) {
    CellLists unoccluded = in.lists;
    unoccluded.occlusion = {};
    choice.desc.constants = light_constants(unoccluded);
  }
  choice.desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  choice.desc.blend = Blend::premultiplied_over;
  out.blended = declare_runs(
      builder, in.scene, in.draws, in.deformed, [](const DrawRun& r) { return r.alpha == AlphaMode::blend; }, choice);
  for (uint32_t i = 0; i < term_count; ++i) {
    if (!in.wanted[i]) continue;
    ImageHandle image = Term(i) == Term::background ? in.background : ImageHandle{};
    if (!image)
      image = builder.create(ImageDesc{"terms." + std::string(layers[i].name), color_format, in.scene.width_px,
                                       in.scene.height_px, in.scene.samples});
    out.images[i] = builder.write(image, Access::color_attachment);
  }
  return out;
}

void Terms::record(CommandList& commands, const In& in, const Out& out) const {
  std::vector<CommandList::Attachment> colors;
  for (const ImageHandle image : out.images)
    if (image) colors.push_back({image});
  const CellLists* const lists = wants_lighting(in) ? &in.lists : nullptr;
  commands.begin_rendering(colors, in.depth);
  if (out.reflected) {
    record_runs(commands, in.scene, in.draws, in.deformed, out.opaque, lists);
    record_reflected(commands, in.scene, in.reflected, in.depth, out.reflected);
    record_runs(commands, in.scene, in.draws, in.deformed, out.blended, lists);
  } else {
    // Blended runs come after the others in the order of drawing.
    RunPipelines all = out.opaque;
    for (size_t r = 0; r < all.by_run.size(); ++r)
      if (out.blended.by_run[r]) all.by_run[r] = out.blended.by_run[r];
    record_runs(commands, in.scene, in.draws, in.deformed, all, lists);
  }
  commands.end_rendering();
}

}  // namespace candela
