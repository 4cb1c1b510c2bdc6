#include "passes/occlusion/occlusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "passes/shared/features.h"
#include "shared/occlusion.h"

namespace candela {
namespace {

// A subsample has a fraction of the slices, but for these: fewer leave an error that reflections, which are not linear
// in V, would show.
constexpr uint32_t least_slices = 4;

uint32_t slices_of(const AmbientOcclusion& pass, const AmbientOcclusion::In& in) {
  const uint32_t slices = uint32_t(pass.knobs.slices);
  return std::max((slices + in.subsamples() - 1) / in.subsamples(), std::min(slices, least_slices));
}

// Of a texel: a subsample has its share.
uint32_t share_of(int rays, const AmbientOcclusion::In& in) {
  return (uint32_t(rays) + in.subsamples() - 1) / in.subsamples();
}
// Side of the squares of texels that a thread of a round of the filter makes (occlusion_filter.comp).
uint32_t filter_block(int round) { return round < 2 ? 2 : 1; }
uint32_t rays_of(const AmbientOcclusion& pass, const AmbientOcclusion::In& in) { return share_of(pass.knobs.rays, in); }

}  // namespace

std::span<const Knob> OcclusionKnobs::table() {
  constexpr std::string_view on_screen = "occlusion.method=screen";
  constexpr std::string_view by_rays = "occlusion.method=rays occlusion.method=traced";
  static const Knob table[] = {
      {.name = "method",
       .member = &OcclusionKnobs::method,
       .lowest = OcclusionKnobs::screen,
       .highest = OcclusionKnobs::automatic,
       .levels = {OcclusionKnobs::screen, OcclusionKnobs::automatic, OcclusionKnobs::automatic,
                  OcclusionKnobs::at_surfaces},
       .description = "how hidden sky is found: in the depth buffer (screen); by rays from texels, whose values are "
                      "filtered (rays); by rays from every shaded surface (traced). auto: rays, or screen where trees "
                      "for rays cost too much",
       .choices = {"screen", "traced", "rays", "auto"},
       .sweep = {OcclusionKnobs::screen, OcclusionKnobs::by_rays, OcclusionKnobs::at_surfaces}},
      {.name = "rays",
       .member = &OcclusionKnobs::rays,
       .lowest = 1,
       .highest = 65536,
       .levels = {1, 1, 4, 256},
       .description = "rays of a texel, or with method traced of a pixel; fewer leave noise",
       .sweep = {1, 4, 16, 64, 256},
       .required = by_rays},
      {.name = "most_rays",
       .member = &OcclusionKnobs::most_rays,
       .lowest = 1,
       .highest = 65536,
       .levels = {1, 1, 8, 16},
       .description =
           "method rays: rays of a texel, at most, where the filter finds few texels of the same surface; fewer leave "
           "noise on what is narrow, which crawls in films",
       .sweep = {1, 2, 4, 8, 16},
       .required = "occlusion.method=rays"},
      {.name = "filter",
       .member = &OcclusionKnobs::filter,
       .lowest = 0,
       .highest = 4,
       .levels = {2, 2, 2, 0},
       .description = "method rays: rounds of the filter, each four times as wide; blurs contacts, fewer leave noise",
       .sweep = {3, 2, 1, 0},
       .required = "occlusion.method=rays occlusion.rays=64"},
      {.name = "reach",
       .member = &OcclusionKnobs::reach,
       .lowest = 0.001,
       .highest = 100,
       .levels = {0.25f},
       .description = "method screen: how far away surfaces can hide the sky, as a part of the point's distance from "
                      "the camera, if the look names no radius; in truth there is no limit",
       .sweep = {0.1f, 0.5f, 1, 0.25f},
       .required = on_screen},
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
       .required = "occlusion.method=screen occlusion.method=rays"},
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
       .description = "depths read on each side of a slice; fewer miss what hides the sky",
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
       .levels = {0},
       .description = "1: the sky's light comes from about the mean open direction, not from about the normal",
       .sweep = {1, 0},
       .required = "occlusion.method=screen occlusion.method=traced"},
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
  if (!any || knobs.method != Knobs::at_surfaces) return any;
  return {false, "occlusion.method is traced: rays are sent where surfaces are shaded"};
}

bool AmbientOcclusion::traced(const SceneFacts& facts, const FrameRequest& request) const {
  return knobs.method == Knobs::at_surfaces && (request.has_layer("occlusion") || shades(facts, request));
}

uint32_t AmbientOcclusion::shape(const SceneInputs& scene) const {
  const bool by_rays = knobs.method == Knobs::by_rays;
  return uint32_t(knobs.texel_px) | scene.samples << 8 | (by_rays ? 1u << 17 : uint32_t(knobs.bent) << 16);
}

glm::uvec2 AmbientOcclusion::texels(const SceneInputs& scene) const {
  const uint32_t side = uint32_t(knobs.texel_px);
  return {(scene.width_px + side - 1) / side, (scene.height_px + side - 1) / side};
}

AmbientOcclusion::Out AmbientOcclusion::declare(GraphBuilder& builder, const In& in) const {
  const glm::uvec2 size = texels(in.scene), picture{in.scene.width_px, in.scene.height_px};
  const std::vector<SpecConstant> points = {{0, "SHAPE", shape(in.scene)}};
  const auto image = [&](const std::string& name, VkFormat format, glm::uvec2 px) {
    return builder.create(ImageDesc{.name = name, .format = format, .width_px = px.x, .height_px = px.y});
  };
  const bool by_rays = knobs.method == Knobs::by_rays;
  const VkFormat format = by_rays || knobs.bent != 0 ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_R32G32_SFLOAT;
  const int rounds = by_rays ? knobs.filter : knobs.denoise;
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  Out out;
  out.find = builder.pipeline(ComputePipelineDesc{with_depth("occlusion_points.comp", in.depth), points});
  builder.begin_step();
  read_depth(builder, in.depth);
  out.points = builder.write(image("occlusion.points", VK_FORMAT_R32_SFLOAT, by_rays ? size : picture),
                             Access::storage_image_write);

  ComputePipelineDesc integrate{"occlusion.comp", points};
  if (by_rays) {
    const TracedRays& rays = in.scene.rays;
    const bool by_query = rays.tree.traversal == BvhKnobs::by_query;
    integrate = {"occlusion_rays.comp", ray_constants(rays.stack, rays.blended, by_query)};
    integrate.constants.push_back({30, "SHAPE", shape(in.scene)});
    for (const SpecConstant& c : in.scene.features)
      if (Feature(c.id) == Feature::ibl_method || Feature(c.id) == Feature::relief) integrate.constants.push_back(c);
    if (by_query) integrate.shader += "#TRACE_QUERY=1";
    if (meets_reliefs(integrate.constants)) integrate.shader += "#RELIEFS=1";
    for (const Knob& row : BvhKnobs::table())
      builder.knob(fmt::format("{}.{}", BvhKnobs::name, row.name), row.text(row.value(&rays.tree)));
  }
  if (rounds > 0) integrate.constants.push_back({by_rays ? 31u : 1u, "KEEPS_NORMALS", 1});
  integrate.shader = with_depth(integrate.shader, in.depth);
  out.integrate = builder.pipeline(integrate);
  builder.begin_step();
  read_depth(builder, in.depth);
  builder.read(out.points, Access::sampled_compute, "points");
  if (by_rays) {
    builder.read(in.scene.trees, Access::compute_read, "the trees for rays");
    builder.read(in.scene.ray_settings, Access::compute_read, "how rays are sent");
    builder.read(in.scene.materials, Access::compute_read, "the scene");
  }
  out.open = builder.write(image("occlusion", format, size), Access::storage_image_write);
  if (rounds == 0) return out;
  out.normals = builder.write(image("occlusion.normals", VK_FORMAT_R32_UINT, size), Access::storage_image_write);
  for (int i = 0; i < rounds; ++i) {
    ComputePipelineDesc smooth{by_rays ? "occlusion_filter.comp" : "occlusion_denoise.comp", points};
    if (by_rays) smooth.constants.push_back({1, "BLOCK", filter_block(i)});
    out.smooth.push_back(builder.pipeline(smooth));
    out.rounds.push_back(out.open);
    builder.begin_step();
    builder.read(out.normals, Access::sampled_compute, "normals");
    builder.read(out.open, Access::sampled_compute, "noisy occlusion");
    const std::string name = i + 1 == rounds ? "occlusion.smooth" : fmt::format("occlusion.round{}", i);
    out.open = builder.write(image(name, format, size), Access::storage_image_write);
  }
  return out;
}

void AmbientOcclusion::record(CommandList& commands, const In& in, const Out& out) const {
  const glm::uvec2 size = texels(in.scene);
  const size_t step = commands.step();
  if (step == 0) {
    commands.bind(out.find);
    shared::OcclusionPointsPush push{};
    push_depth(commands, in.depth, push);
    push.points = commands.storage(out.points);
    const bool by_rays = knobs.method == Knobs::by_rays;
    push.points_px = by_rays ? size : glm::uvec2(in.scene.width_px, in.scene.height_px);
    commands.push(push);
    commands.dispatch_picture(push.points_px.x, push.points_px.y, PicturePart::seen,
                              by_rays ? uint32_t(knobs.texel_px) : 1);
    return;
  }
  // Without a radius what the screen shows hides as far as a part of the distance, in which lengths are then meant.
  const bool endless = std::isinf(in.look->radius_m);
  const float radius = endless ? knobs.reach : float(in.look->radius_m);
  if (step == 1) {
    const ImageHandle open = out.rounds.empty() ? out.open : out.rounds.front();
    commands.bind(out.integrate);
    if (knobs.method == Knobs::by_rays) {
      shared::OcclusionRaysPush push{};
      push_depth(commands, in.depth, push);
      push.trees = commands.address(in.scene.trees);
      push.rays = commands.address(in.scene.ray_settings);
      push.points = commands.sampled(out.points);
      push.normals = out.normals ? commands.storage(out.normals) : 0;
      push.open = commands.storage(open);
      push.texels = size;
      push.subsample_ndc = in.scene.subsample_ndc();
      push.subsample = in.scene.subsample();
      push.count = rays_of(*this, in);
      push.most = out.rounds.empty() ? push.count : share_of(std::max(knobs.rays, knobs.most_rays), in);
      push.rounds = uint32_t(out.rounds.size());
      push.seed = in.seed;
      commands.push(push);
    } else {
      shared::OcclusionPush push{};
      push.points = commands.sampled(out.points);
      push_depth(commands, in.depth, push);
      push.normals = out.normals ? commands.storage(out.normals) : 0;
      push.open = commands.storage(open);
      push.texels = size;
      push.subsample_ndc = in.scene.subsample_ndc();
      push.radius_m = radius;
      push.fade_m = std::max(float(in.look->falloff) * radius, 1e-6f * radius);
      push.by_distance = endless ? 1 : 0;
      push.strength = float(in.look->strength);
      push.slices = int(slices_of(*this, in));
      push.samples = knobs.samples;
      push.turn = float(in.scene.subsample()) / float(in.subsamples());
      push.pattern = {in.seed & 3u, in.seed >> 2 & 3u};
      commands.push(push);
    }
    commands.dispatch_picture(size.x, size.y, PicturePart::shaded, uint32_t(knobs.texel_px));
    return;
  }
  const size_t round = step - 2;
  const ImageHandle from = out.rounds[round];
  const ImageHandle to = round + 1 < out.rounds.size() ? out.rounds[round + 1] : out.open;
  commands.bind(out.smooth[round]);
  if (knobs.method == Knobs::by_rays) {
    shared::OcclusionFilterPush push{};
    push.normals = commands.sampled(out.normals);
    push.open = commands.sampled(from);
    push.smooth_open = commands.storage(to);
    push.texels = size;
    push.subsample_ndc = in.scene.subsample_ndc();
    push.stride = 1 << 2 * round;
    const uint32_t rays = rays_of(*this, in);
    // Single rays say nothing of likeness. The variance of stratified means falls with the square of the rays.
    push.sharpness = round == 0 ? 0 : 2 * float(rays * rays);
    commands.push(push);
  } else {
    shared::OcclusionDenoisePush push{};
    push.normals = commands.sampled(out.normals);
    push.open = commands.sampled(from);
    push.smooth_open = commands.storage(to);
    push.reach_m = std::max(0.15f * radius, 1e-30f);
    push.by_distance = endless ? 1 : 0;
    push.texels = size;
    push.subsample_ndc = in.scene.subsample_ndc();
    commands.push(push);
  }
  const uint32_t block = knobs.method == Knobs::by_rays ? filter_block(int(round)) : 1;
  // A square's texels lie in a square of 2 by 2 of them, or of 8 by 8.
  const uint32_t whole = block == 1 || round == 0 ? 1 : shared::occlusion_filter_y;
  const auto threads = [&](uint32_t texels) { return (texels + block * whole - 1) / (block * whole) * whole; };
  commands.dispatch_picture(threads(size.x), threads(size.y), PicturePart::shaded, block * uint32_t(knobs.texel_px));
}

}  // namespace candela
