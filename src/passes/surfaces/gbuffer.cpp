#include "passes/surfaces/gbuffer.h"

#include <algorithm>

#include "base/scratch.h"
#include "passes/shared/features.h"

namespace candela {
namespace {
// As shaders/lib/gbuffer.glsl.
uint32_t lobe_images(const SceneInputs& scene) { return scatters_in_bodies(scene.features) ? 6 : 5; }
constexpr VkFormat words = VK_FORMAT_R32G32B32A32_UINT;
constexpr uint32_t most_attachments = 8;  // of every device that Vulkan 1.3 knows
}  // namespace

std::span<const Knob> GBufferKnobs::table() {
  static const Knob table[] = {
      {.name = "format",
       .member = &GBufferKnobs::format,
       .lowest = 0,
       .highest = 4,
       .levels = {},
       .description =
           "what a sample holds: 16 bytes, with an exponent or a roughness, 32 bytes, with positions or depths, "
           "or every value as shading makes it",
       .choices = {"specular", "bits128", "position", "packed", "float"},
       .sweep = {0, 1, 2, 3, 4}},
  };
  return table;
}

Need GBuffer::needed(const SceneFacts& facts, const FrameRequest&) const { return needed_for_solid_surfaces(facts); }

GBuffer::Out GBuffer::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  builder.read(in.depth, Access::depth_test, "depth");
  BatchPipelineChoice choice;
  choice.desc.vertex_shader = "draw.vert";
  choice.desc.depth_format = depth_format;
  choice.desc.samples = s.samples;
  choice.desc.depth_test = true;
  choice.desc.depth_compare = VK_COMPARE_OP_EQUAL;
  choice.desc.constants = light_constants(in.lists);
  const bool in_plane = !choice.desc.constants.empty();
  Out out;
  GBufferImages& g = out.gbuffer;
  // Lobes take the places of images that this would need.
  const bool mirrors = mirrors_sky(s.features) && !shades_lobes(s.features);
  const uint32_t own = knobs.format == Knobs::floats     ? (mirrors    ? 8
                                                            : in_plane ? 7
                                                                       : 5)
                       : knobs.format >= Knobs::position ? 2
                                                         : 1;
  g.definitions = fmt::format("#GBUFFER={}", own);
  if (knobs.format != Knobs::floats) g.definitions += fmt::format("#PACKED={}", knobs.format + 1);
  const auto declare_step = [&](uint32_t count, std::string_view what, const std::string& defined, bool of_reliefs) {
    builder.begin_step();
    choice.desc.color_formats.assign(count, words);
    choice.desc.fragment_shader = "gbuffer.frag" + g.definitions + defined;
    for (uint32_t i = 0; i < count; ++i) {
      const ImageDesc desc{fmt::format("gbuffer.{}{}", what, i), words, s.width_px, s.height_px, s.samples};
      g.images[g.count++] = builder.write(builder.create(desc), Access::color_attachment);
    }
    return declare_batches(
        builder, s, in.draws, in.deformed, [=](const DrawBatch& r) { return r.solid() && (r.relief || !of_reliefs); },
        choice);
  };
  // Which relief it is stands beside the rest, or in a step of its own where that takes all attachments.
  g.reliefs = (in.lists.sun_maps || in.lists.lamp_maps) && marches_to_lights(s.features) &&
              std::ranges::any_of(*s.draw_batches, [](const DrawBatch& r) { return r.solid() && r.relief; });
  out.own_images = own + (g.reliefs && own < most_attachments ? 1 : 0);
  out.own = declare_step(out.own_images, "", out.own_images > own ? "#RELIEF_BESIDE=1" : "", false);
  if (g.reliefs && out.own_images == own) out.reliefs = declare_step(1, "relief", "#RELIEF_APART=1", true);
  if (shades_lobes(s.features)) out.lobes = declare_step(lobe_images(s), "lobes", "#LOBES_APART=1", false);
  if (g.reliefs) g.definitions += "#RELIEF_TEXEL=1";
  return out;
}

void GBuffer::record(CommandList& commands, const In& in, const Out& out) const {
  const bool apart = !out.reliefs.by_run.empty();
  const uint32_t step = commands.step() + (commands.step() > 0 && !apart ? 1 : 0);
  const uint32_t ends[] = {0, out.own_images, out.own_images + (apart ? 1 : 0), out.gbuffer.count};
  const uint32_t first = ends[step], last = ends[step + 1];
  Scratch scratch;
  ScratchVector<CommandList::Attachment> colors(&scratch);
  for (uint32_t i = first; i < last; ++i) colors.push_back({out.gbuffer.images[i]});
  commands.begin_picture(colors, in.depth);
  record_batches(commands, in.scene, in.draws, in.deformed, step == 0 ? out.own : step == 1 ? out.reliefs : out.lobes);
  commands.end_rendering();
}

}  // namespace candela
