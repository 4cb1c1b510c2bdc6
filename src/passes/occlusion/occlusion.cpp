#include "passes/occlusion/occlusion.h"

#include <algorithm>

#include "shared/occlusion.h"

namespace candela {
namespace {

// A subsample has a fraction of the slices, but for these: fewer leave an error that reflections, which are not linear
// in V, would show.
constexpr uint32_t least_slices = 4;

uint32_t slices_of(const AmbientOcclusion& pass, const AmbientOcclusion::In& in) {
  const uint32_t slices = uint32_t(pass.knobs.slices);
  return std::max((slices + in.subsamples - 1) / in.subsamples, std::min(slices, least_slices));
}

}  // namespace

std::span<const Knob> OcclusionKnobs::table() {
  constexpr std::string_view on_screen = "occlusion.method=screen";
  static const Knob table[] = {
      screen_or_rays_row<OcclusionKnobs>(
          "what hides the sky: what the depth buffer shows, or rays to all that there is"),
      {.name = "rays",
       .member = &OcclusionKnobs::rays,
       .lowest = 1,
       .highest = 65536,
       .levels = {16, 64, 64, 256},
       .description = "method traced: rays of a pixel; fewer leave noise",
       .sweep = {1, 4, 16, 64, 256},
       .required = "occlusion.method=traced"},
      {.name = "texel_px",
       .member = &OcclusionKnobs::texel_px,
       .unit = "px",
       .lowest = 1,
       .highest = 4,
       .levels = {2, 2, 2, 1},
       .description =
           "side of a texel of ambient occlusion: 1 full resolution, 2 half; coarser ones blur contacts and edges",
       .sweep = {4, 2, 1},
       .only = {1, 2, 4},
       .required = on_screen},
      {.name = "slices",
       .member = &OcclusionKnobs::slices,
       .lowest = 1,
       .highest = 256,
       .levels = {2, 3, 3, 64},
       .description = "planes through the view vector in which horizons are searched; fewer leave noise",
       .sweep = {1, 2, 3, 8, 64},
       .required = on_screen},
      {.name = "samples",
       .member = &OcclusionKnobs::samples,
       .lowest = 1,
       .highest = 512,
       .levels = {4, 6, 6, 64},
       .description = "depths that are looked at on each side of a slice; fewer miss what hides the sky",
       .sweep = {1, 2, 4, 6, 16, 64},
       .required = on_screen},
      {.name = "denoise",
       .member = &OcclusionKnobs::denoise,
       .lowest = 0,
       .highest = 1,
       .levels = {1, 1, 1, 0},
       .description = "1: the mean over 5 by 5 texels of the same surface; blurs contacts where slices are many",
       .sweep = {1, 0},
       .required = "occlusion.method=screen occlusion.slices=64"},
      {.name = "bent",
       .member = &OcclusionKnobs::bent,
       .lowest = 0,
       .highest = 1,
       .levels = {0, 0, 0, 1},
       .description = "1: the sky's light comes from about the mean open direction, not from about the normal",
       .sweep = {0, 1}},
  };
  return table;
}

Need AmbientOcclusion::shades(const SceneFacts& facts, const FrameRequest& request) {
  if (facts.lit_items == 0) return {false, "the scene has no opaque or masked surface that takes light"};
  if (!request.wants_true(effect)) return {false, "ambient occlusion is not wanted (--effects, --quality)"};
  return needed_if(facts.environment || request.neutral_light, "the scene has no ambient light (--sky)");
}

Need AmbientOcclusion::needed(const SceneFacts& facts, const FrameRequest& request) const {
  const Need any = request.has_layer("occlusion") ? Need{} : shades(facts, request);
  if (!any || knobs.method == Knobs::screen) return any;
  return {false, "occlusion.method is traced: rays are sent where surfaces are shaded"};
}

bool AmbientOcclusion::traced(const SceneFacts& facts, const FrameRequest& request) const {
  return knobs.method == Knobs::by_rays && (request.has_layer("occlusion") || shades(facts, request));
}

uint32_t AmbientOcclusion::shape(const SceneInputs& scene) const {
  return uint32_t(knobs.texel_px) | scene.samples << 8 | uint32_t(knobs.bent) << 16;
}

glm::uvec2 AmbientOcclusion::texels(const SceneInputs& scene) const {
  const uint32_t side = uint32_t(knobs.texel_px);
  return {(scene.width_px + side - 1) / side, (scene.height_px + side - 1) / side};
}

AmbientOcclusion::Out AmbientOcclusion::declare(GraphBuilder& builder, const In& in) const {
  const glm::uvec2 size = texels(in.scene), picture{in.scene.width_px, in.scene.height_px};
  std::vector<SpecConstant> constants = {{0, "SHAPE", shape(in.scene)}};
  const auto image = [&](const char* name, VkFormat format, glm::uvec2 px) {
    return builder.create(ImageDesc{.name = name, .format = format, .width_px = px.x, .height_px = px.y});
  };
  const VkFormat format = knobs.bent != 0 ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_R32G32_SFLOAT;
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  Out out;
  out.find = builder.pipeline(ComputePipelineDesc{with_depth("occlusion_points.comp", in.depth), constants});
  builder.begin_step();
  read_depth(builder, in.depth);
  out.points = builder.write(image("occlusion.points", VK_FORMAT_R32_SFLOAT, picture), Access::storage_image_write);
  if (knobs.denoise != 0) constants.push_back({1, "KEEPS_NORMALS", 1});
  out.integrate = builder.pipeline(ComputePipelineDesc{with_depth("occlusion.comp", in.depth), constants});
  builder.begin_step();
  read_depth(builder, in.depth);
  builder.read(out.points, Access::sampled_compute, "points");
  out.open = builder.write(image("occlusion", format, size), Access::storage_image_write);
  if (knobs.denoise != 0)
    out.normals = builder.write(image("occlusion.normals", VK_FORMAT_R32_UINT, size), Access::storage_image_write);
  if (knobs.denoise == 0) return out;
  out.noisy = out.open;
  out.smooth = builder.pipeline(ComputePipelineDesc{"occlusion_denoise.comp", {{0, "SHAPE", shape(in.scene)}}});
  builder.begin_step();
  builder.read(out.normals, Access::sampled_compute, "normals");
  builder.read(out.noisy, Access::sampled_compute, "noisy occlusion");
  out.open = builder.write(image("occlusion.smooth", format, size), Access::storage_image_write);
  return out;
}

void AmbientOcclusion::record(CommandList& commands, const In& in, const Out& out) const {
  const glm::uvec2 size = texels(in.scene);
  if (commands.step() == 0) {
    commands.bind(out.find);
    shared::OcclusionPointsPush push{};
    push_depth(commands, in.depth, push);
    push.points = commands.storage(out.points);
    commands.push(push);
    commands.dispatch(in.scene.width_px, in.scene.height_px);
    return;
  }
  if (commands.step() == 1) {
    shared::OcclusionPush push{};
    push.points = commands.sampled(out.points);
    push_depth(commands, in.depth, push);
    push.normals = out.normals ? commands.storage(out.normals) : 0;
    push.open = commands.storage(out.noisy ? out.noisy : out.open);
    push.texels = size;
    push.subsample_ndc = in.scene.subsample_ndc;
    push.radius_m = float(in.look.radius_m);
    push.fade_m = std::max(float(in.look.falloff * in.look.radius_m), 1e-6f * push.radius_m);
    push.strength = float(in.look.strength);
    push.slices = int(slices_of(*this, in));
    push.samples = knobs.samples;
    push.turn = float(in.subsample) / float(in.subsamples);
    push.pattern = {in.seed & 3u, in.seed >> 2 & 3u};
    commands.bind(out.integrate);
    commands.push(push);
  } else {
    shared::OcclusionDenoisePush push{};
    push.normals = commands.sampled(out.normals);
    push.open = commands.sampled(out.noisy);
    push.smooth_open = commands.storage(out.open);
    push.reach_m = std::max(0.15f * float(in.look.radius_m), 1e-30f);
    push.texels = size;
    push.subsample_ndc = in.scene.subsample_ndc;
    commands.bind(out.smooth);
    commands.push(push);
  }
  commands.dispatch(size.x, size.y);
}

}  // namespace candela
