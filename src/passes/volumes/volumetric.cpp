#include "passes/volumes/volumetric.h"

#include <cmath>

#include "passes/shared/push_lights.h"
#include "shared/volumetric.h"

namespace candela {
namespace {

// Rows and columns of a filter, in their order: twice bilateral and once not, or three times not.
struct FilterStep {
  bool bilateral = false, down = false;
};
std::vector<FilterStep> filter_steps(VolumetricLight::Filter filter) {
  std::vector<FilterStep> steps;
  if (filter == VolumetricLight::Filter::none) return steps;
  for (int i = 0; i < 3; ++i)
    for (const bool down : {false, true})
      steps.push_back({filter == VolumetricLight::Filter::bilateral && i < 2, down});
  return steps;
}

constexpr float same_surface = 0.05f;  // of a depth

}  // namespace

std::span<const Knob> VolumetricLight::Knobs::table() {
  static const Knob table[] = {
      {.name = "texel_px",
       .member = &Knobs::texel_px,
       .unit = "px",
       .lowest = 1,
       .highest = 8,
       .levels = {4, 2, 2, 1},
       .description = "side of a texel of light in the air: 1 full resolution, 2 half",
       .sweep = {4, 2, 1}},
      {.name = "samples",
       .member = &Knobs::samples,
       .lowest = 1,
       .highest = 4096,
       .levels = {16, 50, 50, 512},
       .description = "steps of a ray at which shadows are asked; fewer leave bands, which the offsets turn into noise",
       .sweep = {8, 16, 50, 128, 512}},
      {.name = "bayer",
       .member = &Knobs::bayer,
       .lowest = 1,
       .highest = 8,
       .levels = {4, 4, 4, 1},
       .description = "side of the matrix of offsets at which neighbouring rays begin; 1: all at the middle of a step",
       .sweep = {8, 4, 2, 1},
       .only = {1, 2, 4, 8}},
      {.name = "filter",
       .member = &Knobs::filter,
       .lowest = 0,
       .highest = 2,
       .levels = {2, 0, 0, 0},
       .description =
           "gauss: three times, also over edges; bilateral: twice by depth, then gauss once; both hide the pattern "
           "of the offsets and blur glows; none does neither",
       .choices = {"none", "gauss", "bilateral"},
       .sweep = {1, 2, 0}},
      {.name = "depth",
       .member = &Knobs::depth,
       .lowest = 0,
       .highest = 1,
       .levels = {0, 1, 1, 1},
       .description = "which of its pixels a texel follows: the nearest, or nearest and farthest alternately",
       .choices = {"nearest", "checkerboard"},
       .sweep = {0, 1}},
      {.name = "upsample",
       .member = &Knobs::upsample,
       .lowest = 0,
       .highest = 1,
       .levels = {0, 1, 1, 1},
       .description = "how a pixel takes its texels: bilinear, also over edges, or by depth",
       .choices = {"bilinear", "depth"},
       .sweep = {0, 1}},
  };
  return table;
}

Need VolumetricLight::needed(const SceneFacts& facts, const FrameRequest& request) const {
  if (!request.look.volumetric) return {false, "the look has no volumetric light (--look)"};
  if (!request.draws_volumetric()) return {false, "volumetric light is not wanted (--effects)"};
  return needed_if(facts.point_lights + facts.spot_lights > 0, "no point or spot light shines");
}

VolumetricLight::Out VolumetricLight::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  const uint32_t side = uint32_t(knobs.texel_px);
  const glm::uvec2 texels((s.width_px + side - 1) / side, (s.height_px + side - 1) / side);
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  builder.read(in.color, Access::sampled_compute, "color");
  const uint32_t samples = in.depth ? s.samples : 0;
  Out out;
  const auto filters = filter_steps(Filter(knobs.filter));
  const auto coarse = [&](const char* image) {
    return builder.create(
        ImageDesc{.name = image, .format = color_format, .width_px = texels.x, .height_px = texels.y});
  };
  out.coarse[0] = coarse("volumetric.light");
  if (!filters.empty()) out.coarse[1] = coarse("volumetric.filtered");
  std::string march = with_depth("volumetric_march.comp", in.depth);
  if (in.lists.lamp_maps) march += in.lists.deep.lamps ? "#LAMP_SHADOWS=1#FOG_DEEP_SHADOWS=2" : "#LAMP_SHADOWS=1";
  out.pipelines.push_back(builder.pipeline(ComputePipelineDesc{march, {{0, "DEPTH_SAMPLES", samples}}}));
  builder.begin_step();
  for (const BufferHandle b : {s.lights, s.light_globals, in.lists.cells, in.lists.entries, in.lists.tiles})
    builder.read_optional(b, Access::compute_read);
  if (in.lists.lamp_maps) {
    builder.read_optional(in.lists.deep.lamps, Access::sampled_compute);
    builder.read(in.lists.lamp_maps, Access::sampled_compute, "the local lights' maps");
    builder.read(s.lamps, Access::compute_read, "the local lights' tiles");
  }
  if (in.depth) read_depth(builder, in.depth);
  out.coarse[0] = builder.write(out.coarse[0], Access::storage_image_write);
  for (size_t i = 0; i < filters.size(); ++i) {
    out.pipelines.push_back(builder.pipeline(ComputePipelineDesc{"volumetric_filter.comp", {}}));
    builder.begin_step();
    builder.read(out.coarse[i % 2], Access::sampled_compute, "the light so far");
    out.coarse[1 - i % 2] = builder.write(out.coarse[1 - i % 2], Access::storage_image_write);
  }
  std::vector<SpecConstant> constants = {{0, "DEPTH_SAMPLES", samples}};
  if (in.layer_wanted) constants.push_back({1, "HAS_LAYER", 1});
  out.pipelines.push_back(
      builder.pipeline(ComputePipelineDesc{with_depth("volumetric_composite.comp", in.depth), constants}));
  builder.begin_step();
  builder.read(out.coarse[0], Access::sampled_compute, "the light");
  if (in.depth) read_depth(builder, in.depth);
  const auto full = [&](const char* image) {
    return builder.write(builder.create(ImageDesc{
                             .name = image, .format = color_format, .width_px = s.width_px, .height_px = s.height_px}),
                         Access::storage_image_write);
  };
  out.color = full("volumetric.composed");
  if (in.layer_wanted) {
    out.layer = full("volumetric.layer");
    builder.publish("volumetric", out.layer);
  }
  return out;
}

void VolumetricLight::record(CommandList& commands, const In& in, const Out& out) const {
  const uint32_t step = commands.step();
  const auto filters = filter_steps(Filter(knobs.filter));
  const glm::uvec2 texels = commands.size(out.coarse[0]);
  commands.bind(out.pipelines[step]);
  if (step == 0) {
    shared::VolumetricMarchPush push{};
    Lighting lists = in.lists;
    lists.deep.suns = {};
    push_light_lists(commands, in.scene, lists, push);
    push_depth(commands, in.depth, push);
    push.target = commands.storage(out.coarse[0]);
    push.texels = texels;
    push.texel_px = uint32_t(knobs.texel_px), push.rule = uint32_t(knobs.depth);
    push.samples = uint32_t(knobs.samples), push.bayer = uint32_t(knobs.bayer);
    push.farthest_m = in.scene.values->volumetric_reach_m;
    push.phi = float(in.look->phi), push.tau = float(in.look->tau_per_m);
    push.anisotropy = float(in.look->anisotropy);
    push.formula = in.look->by_attenuation ? shared::volumetric_attenuation : shared::volumetric_extinction;
    commands.push(push);
    commands.dispatch_picture(texels.x, texels.y, PicturePart::shaded, uint32_t(knobs.texel_px));
  } else if (step <= filters.size()) {
    const FilterStep& filter = filters[step - 1];
    const uint32_t from = (step - 1) % 2;
    shared::VolumetricFilterPush push{};
    push.source = commands.sampled(out.coarse[from]);
    push.target = commands.storage(out.coarse[1 - from]);
    push.texels = texels;
    push.down = filter.down ? 1 : 0;
    // Three of them are as wide as the matrix of offsets, whose pattern would show otherwise; more would blur glows.
    push.deviation = float(knobs.bayer) / 6;
    push.radius = uint32_t(std::ceil(2.5f * push.deviation));
    push.depth_fraction = filter.bilateral ? same_surface : 0;
    commands.push(push);
    commands.dispatch_picture(texels.x, texels.y, PicturePart::shaded, uint32_t(knobs.texel_px));
  } else {
    shared::VolumetricCompositePush push{};
    push.color = commands.sampled(in.color);
    push.light = commands.sampled(out.coarse[0]);
    push_depth(commands, in.depth, push);
    push.composed = commands.storage(out.color);
    push.layer = out.layer ? commands.storage(out.layer) : 0;
    push.size_px = {in.scene.width_px, in.scene.height_px};
    push.texels = texels;
    push.texel_px = uint32_t(knobs.texel_px), push.aware = uint32_t(knobs.upsample);
    commands.push(push);
    commands.dispatch_picture(in.scene.width_px, in.scene.height_px);
  }
}

}  // namespace candela
