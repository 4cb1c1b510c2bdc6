#include "passes/transparency/moments.h"

#include <array>
#include <bit>

namespace candela {
std::span<const Knob> Moments::Knobs::table() {
  static const Knob table[] = {
      {.name = "count",
       .member = &Knobs::count,
       .lowest = 4,
       .highest = 8,
       .levels = {4, 4, 4, 8},
       .description = "number of depth moments: more follow more steps of transmittance, and take memory and time; "
                      "exact is --transparency layers",
       .sweep = {4, 6, 8},
       .only = {4, 6, 8}},
  };
  return table;
}

Need Moments::needed(const SceneFacts& facts, const FrameRequest& request) const {
  return needs_method(facts, request, method);
}

Moments::Out Moments::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  const auto image = [&](const char* name, VkFormat format) {
    return builder.create(ImageDesc{name, format, s.width_px, s.height_px, s.samples});
  };
  const auto write = [&](ImageHandle& written) { written = builder.write(written, Access::color_attachment); };
  Out out;
  GraphicsPipelineDesc absorbed;
  out.moments = {image("moments.first", color_format),
                 image("moments.absorbance", knobs.count == 4 ? VK_FORMAT_R32_SFLOAT : color_format)};
  absorbed.color_formats = {color_format, knobs.count == 4 ? VK_FORMAT_R32_SFLOAT : color_format};
  if (knobs.count == 8) {
    out.moments.push_back(image("moments.last", VK_FORMAT_R32_SFLOAT));
    absorbed.color_formats.push_back(VK_FORMAT_R32_SFLOAT);
  }
  out.sum = image("moments.sum", color_format);
  const std::string define = fmt::format("#MOMENTS={}", knobs.count);

  builder.begin_step();
  const bool tested = builder.read_optional(in.depth, Access::depth_test);
  absorbed.vertex_shader = "draw.vert";
  absorbed.fragment_shader = "moments_absorb.frag" + define;
  absorbed.samples = s.samples;
  absorbed.blend = Blend::additive;
  test_depth(absorbed, tested);
  out.absorbed = declare_batches(builder, s, in.draws, in.deformed,
                                 [](const DrawBatch& r) { return r.alpha == AlphaMode::blend; }, {absorbed, {}});
  for (ImageHandle& moments : out.moments) write(moments);

  builder.begin_step();
  for (const ImageHandle moments : out.moments) builder.read(moments, Access::sampled_fragment, "moments");
  GraphicsPipelineDesc drawn;
  drawn.color_formats = {color_format};
  drawn.blend = Blend::additive;
  out.drawn = declare_blended(builder, in, drawn, define + (s.samples > 1 ? "#MULTISAMPLED=1" : ""));
  write(out.sum);

  builder.begin_step();
  out.over = declare_sums_over(builder, s, out.sum, out.moments[1]);
  out.color = builder.write(in.color, Access::color_attachment);
  return out;
}

void Moments::record(CommandList& commands, const In& in, const Out& out) const {
  if (commands.step() == 2) return record_sums_over(commands, in.scene, out.over, out.sum, out.moments[1], out.color);
  OwnInputs own;
  own.word = std::bit_cast<uint64_t>(std::array{in.scene.values->blended_near_m, in.scene.values->blended_far_m});
  if (commands.step() == 0) {
    std::vector<CommandList::Attachment> moments;
    for (const ImageHandle image : out.moments) moments.push_back({image});
    commands.begin_picture(moments, in.depth);
    record_batches(commands, in.scene, in.draws, in.deformed, out.absorbed, nullptr, nullptr, own);
  } else {
    for (size_t i = 0; i < out.moments.size(); ++i) own.number |= commands.sampled(out.moments[i]) << (8 * i);
    const CommandList::Attachment sum{out.sum};
    commands.begin_picture({&sum, 1}, in.depth);
    record_batches(commands, in.scene, in.draws, in.deformed, out.drawn, &in.lists, &in.lists, own);
  }
  commands.end_rendering();
}

}  // namespace candela
