#include "passes/surfaces/shade_volumes.h"

#include "passes/shared/draw_batches.h"
#include "passes/shared/features.h"
#include "shared/light_volumes.h"

namespace candela {

std::span<const Knob> LightVolumeKnobs::table() {
  static const Knob table[] = {
      {.name = "accumulator",
       .member = &LightVolumeKnobs::accumulator,
       .lowest = 0,
       .highest = 2,
       .levels = {},
       .description =
           "what the lights of a sample are summed in: 4, 8 or 16 bytes; small formats lose what a light adds to "
           "a brighter sum",
       .choices = {"r11g11b10", "half", "float"},
       .sweep = {0, 1, 2}},
      {.name = "guard",
       .member = &LightVolumeKnobs::guard,
       .lowest = 0,
       .highest = 2,
       .levels = {},
       .description = "what keeps a light's volume from pixels that its light does not change: nothing, the light's "
                      "reach, or reach and a stencil; the picture is the same",
       .choices = {"none", "reach", "stencil"},
       .sweep = {0, 1, 2}},
      {.name = "depth_test",
       .member = &LightVolumeKnobs::depth_test,
       .lowest = 0,
       .highest = 1,
       .levels = {},
       .description = "1: a light's volume skips samples before or behind it, which misses light where a pixel is "
                      "shaded far from the sample; 0: it takes all that it covers",
       .sweep = {1, 0}},
  };
  return table;
}

Need ShadeVolumes::needed(const SceneFacts& facts, const FrameRequest&) const {
  return needed_for_solid_surfaces(facts);
}

ShadeVolumes::Out ShadeVolumes::declare(GraphBuilder& builder, const In& in) const {
  static constexpr VkFormat formats[] = {VK_FORMAT_B10G11R11_UFLOAT_PACK32, VK_FORMAT_R16G16B16A16_SFLOAT,
                                         VK_FORMAT_R32G32B32A32_SFLOAT};
  const SceneInputs& s = in.scene;
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  read_gbuffer(builder, in.gbuffer, Access::sampled_fragment);
  read_gbuffer_reliefs(builder, in.gbuffer, s, in.deformed, Access::graphics_read);
  std::string defined = in.gbuffer.definitions;
  if (knobs.accumulator != Knobs::floats) defined += "#EXPOSED=1";
  const std::string exposed = defined;
  if (marks()) defined += "#MARKED=1";
  const std::string by_light = defined + (knobs.guard != Knobs::unguarded ? "#REACHED=1" : "");
  GraphicsPipelineDesc desc;
  desc.constants = light_constants(in.lists);
  desc.constants.insert(desc.constants.end(), s.features.begin(), s.features.end());
  desc.constants.push_back({30, "SAMPLES", s.samples});
  const std::string surfaces = surface_definitions(desc.constants);
  desc.samples = s.samples;
  Out out;
  ImageDesc sum{"light_volumes.sum", formats[knobs.accumulator], s.width_px, s.height_px, s.samples};
  out.sum = builder.create(sum);

  if (marks()) {
    builder.begin_step();
    GraphicsPipelineDesc mark = desc;
    mark.vertex_shader = "background.vert";
    mark.fragment_shader = "light_volume_mark.frag" + in.gbuffer.definitions + surfaces;
    mark.depth_format = VK_FORMAT_D32_SFLOAT_S8_UINT;
    mark.stencil_test = true;
    mark.stencil = {.pass = VK_STENCIL_OP_REPLACE};
    out.mark = builder.pipeline(mark);
    const ImageDesc marks{"light_volumes.marks", mark.depth_format, s.width_px, s.height_px, s.samples};
    out.tested = builder.write(builder.create(marks), Access::depth_attachment);
    desc.depth_format = mark.depth_format;
    desc.stencil_test = true;
    desc.stencil = {.compare = VK_COMPARE_OP_EQUAL};
  } else if (knobs.depth_test != 0) {
    out.tested = in.depth;
    desc.depth_format = depth_format;
  }

  builder.begin_step();
  builder.read_optional(out.tested, Access::depth_test);
  declare_lights(builder, s, in.lists, {Access::graphics_read, Access::sampled_fragment});
  declare_fog(builder, s, in.lists, true);
  builder.read_optional(in.volumes.lists, Access::vertex_read);
  builder.read_optional(in.volumes.draws, Access::indirect_read);
  desc.color_formats = {sum.format};
  desc.blend = Blend::additive;
  desc.vertex_shader = "background.vert";
  desc.fragment_shader =
      with_shadow_colors(with_fog("light_volume.frag" + defined + "#BASE=1", in.lists), in.lists.shadow_colors) +
      surfaces;
  out.base = builder.pipeline(desc);
  if (in.volumes.draws)
    for (uint32_t list = 0; list < (knobs.depth_test != 0 ? shared::volume_lists : 1u); ++list) {
      GraphicsPipelineDesc volume = desc;
      volume.vertex_shader =
          fmt::format("light_volume.vert#LIST={}{}", list, knobs.depth_test != 0 ? "" : "#ORDERED=1");
      volume.fragment_shader =
          with_shadow_colors(with_fog("light_volume.frag" + by_light, in.lists), in.lists.shadow_colors) + surfaces;
      volume.depth_test = knobs.depth_test != 0 && list != shared::volumes_everywhere;
      // Reversed: front faces before the surface, back faces behind it.
      volume.depth_compare =
          list == shared::volumes_inside ? VK_COMPARE_OP_LESS_OR_EQUAL : VK_COMPARE_OP_GREATER_OR_EQUAL;
      out.by_list.push_back(builder.pipeline(volume));
    }
  out.sum = builder.write(out.sum, Access::color_attachment);

  builder.begin_step();
  builder.read(out.sum, Access::sampled_fragment, "sums of lights");
  declare_fog(builder, s, in.lists);
  desc.color_formats = {color_format};
  desc.depth_format = VK_FORMAT_UNDEFINED;
  desc.stencil_test = false;
  desc.blend = Blend::none;
  desc.fragment_shader = with_fog("light_volumes_over.frag" + exposed, in.lists) + surfaces;
  out.over = builder.pipeline(desc);
  out.color = write_color(builder, s, {});
  return out;
}

void ShadeVolumes::record(CommandList& commands, const In& in, const Out& out) const {
  enum { mark, sum, over };
  const uint32_t step = commands.step() + (marks() ? 0 : 1);
  OwnInputs own;
  own.word = gbuffer_places(commands, in.gbuffer);
  if (step == sum && in.volumes.lists) own.deformed_before = in.volumes.lists;
  if (step == over) own.word |= uint64_t(commands.sampled(out.sum)) << 60;
  shared::DrawPush push = draw_push(commands, in.scene, in.gbuffer.reliefs ? in.deformed : BufferHandle{},
                                    step == sum ? &in.lists : nullptr, step == mark ? nullptr : &in.lists, own);
  const CommandList::Attachment target{step == sum ? out.sum : out.color};
  if (step == mark)
    commands.begin_picture({}, out.tested);
  else
    commands.begin_picture({&target, 1}, step == sum ? out.tested : ImageHandle{});
  const auto for_samples = [&](PipelineHandle pipeline, auto&& draw) {
    commands.bind(pipeline);
    for (push.own = 0; push.own < in.scene.samples; ++push.own) {
      commands.set_stencil_reference(uint8_t(push.own + 1));  // 0: nothing is seen
      commands.push(push);
      draw();
    }
  };
  for_samples(step == mark ? out.mark : step == sum ? out.base : out.over, [&] { commands.draw(3); });
  for (uint32_t list = 0; step == sum && list < out.by_list.size(); ++list) {
    commands.set_cull(true, list == shared::volumes_inside);
    for_samples(out.by_list[list], [&] {
      commands.draw_indirect_count(in.volumes.draws, list * sizeof(shared::VolumeDraw), in.volumes.draws,
                                   offsetof(shared::VolumeDraws, count) + list * sizeof(uint32_t), 1);
    });
  }
  commands.end_rendering();
}

}  // namespace candela
