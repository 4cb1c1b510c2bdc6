#include "passes/shared/seen_through.h"

#include <bit>

#include "shared/refraction.h"

namespace candela {
namespace {
glm::uvec2 pyramid_px(const SceneInputs& scene) {
  return {std::bit_floor(scene.width_px), std::bit_floor(scene.height_px)};
}
}  // namespace

uint32_t pyramid_levels(const SceneInputs& scene) {
  const glm::uvec2 size = pyramid_px(scene);
  return uint32_t(std::bit_width(std::max(size.x, size.y)));
}

ImageHandle declare_pyramid(GraphBuilder& builder, const SceneInputs& scene, ImageHandle picture, std::string name) {
  const glm::uvec2 size = pyramid_px(scene);
  ImageHandle pyramid = builder.create(ImageDesc{.name = std::move(name),
                                                 .format = color_format,
                                                 .width_px = size.x,
                                                 .height_px = size.y,
                                                 .mips = pyramid_levels(scene)});
  for (uint32_t k = 0; k < pyramid_levels(scene); ++k) {
    builder.begin_step();
    if (k == 0)
      builder.read(picture, Access::sampled_compute, "the picture behind");
    else
      builder.read(pyramid, Access::sampled_compute, "the finer level", ImageRange::mip(k - 1));
    pyramid = builder.write(pyramid, Access::storage_image_write, ImageRange::mip(k));
  }
  return pyramid;
}

void record_level(CommandList& commands, PipelineHandle down, ImageHandle picture, ImageHandle pyramid,
                  glm::uvec2 picture_px, uint32_t level) {
  shared::RefractionDownPush push{};
  push.source = commands.sampled(level == 0 ? picture : pyramid);
  push.target = commands.storage(pyramid);
  push.source_px = level == 0 ? picture_px : commands.size(pyramid, level - 1);
  push.target_px = commands.size(pyramid, level);
  commands.bind(down);
  commands.push(push);
  commands.dispatch(push.target_px.x, push.target_px.y);
}

void declare_seen_through(GraphBuilder& builder, const SceneInputs& scene, const SeenThrough& seen,
                          BatchPipelineChoice& choice) {
  builder.read(seen.picture, Access::sampled_fragment, "the picture behind");
  builder.read(seen.pyramid, Access::sampled_fragment, "the picture's levels");
  builder.read_optional(seen.behind, Access::sampled_fragment);
  if (builder.read_optional(seen.rays, Access::sampled_fragment)) choice.desc.fragment_shader += "#REFRACTION_RAYS=1";
  if (builder.read_optional(seen.sums, Access::sampled_fragment)) {
    builder.read(seen.backs, Access::sampled_fragment, "the nearest back faces");
    choice.desc.fragment_shader += "#BODIES=1";
    choice.desc.constants.push_back({46, "BODY_SEARCH", seen.body_search});
  }
  choice.desc.vertex_shader += "#REFRACTION=1";
  choice.desc.fragment_shader += seen.behind ? "#REFRACTION=2" : "#REFRACTION=1";
  if (seen.lobe_samples > 0) choice.desc.constants.push_back({40, "REFRACTION_SAMPLES", seen.lobe_samples});
  if (scene.samples > 1) choice.desc.constants.push_back({41, "REFRACTION_DEPTH_SAMPLES", scene.samples});
}

OwnInputs own_inputs(CommandList& commands, const SeenThrough& seen) {
  OwnInputs own;
  own.word =
      REFRACTION_IMAGES(commands.sampled(seen.picture), commands.sampled(seen.pyramid),
                        seen.behind ? commands.sampled(seen.behind) : 0u, seen.rays ? commands.sampled(seen.rays) : 0u);
  if (seen.sums)
    own.word |= uint64_t(REFRACTION_IMAGES(commands.sampled(seen.sums), commands.sampled(seen.backs), 0u, 0u)) << 32;
  own.number = std::bit_cast<uint32_t>(seen.roughest);
  return own;
}

}  // namespace candela
