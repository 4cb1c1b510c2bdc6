#include "passes/geometry/depth_pyramid.h"

#include "shared/cull.h"

namespace candela {
namespace {

constexpr uint32_t texels_at_the_end = 4;  // a side; as shaders/occlusion_cull.comp asks

ImageDesc pyramid_desc(const DepthPyramid::In& in) {
  ImageDesc desc{.name = "depth_pyramid", .format = VK_FORMAT_R32_SFLOAT};
  desc.mips = 1;
  while ((texels_at_the_end << desc.mips) < std::max(in.width_px, in.height_px)) ++desc.mips;
  const uint32_t last_px = 1u << desc.mips;  // side of a texel of the last level
  const auto texels = [&](uint32_t size_px) { return (size_px + last_px - 1) / last_px * (last_px / 2); };
  desc.width_px = texels(in.width_px);
  desc.height_px = texels(in.height_px);
  return desc;
}

}  // namespace

DepthPyramid::Out DepthPyramid::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.constants, Access::uniform_read, "the frame's constants");
  const ImageDesc desc = pyramid_desc(in);
  Out out;
  out.pipelines.first =
      builder.pipeline(ComputePipelineDesc{with_depth("depth_pyramid.comp", in.depth), {{0, "SAMPLES", in.samples}}});
  out.pipelines.others = builder.pipeline(ComputePipelineDesc{"depth_pyramid.comp", {}});
  out.pyramid = builder.create(desc);
  for (uint32_t level = 0; level < desc.mips; ++level) {
    builder.begin_step();
    if (level == 0)
      read_depth(builder, in.depth);
    else
      builder.read(out.pyramid, Access::sampled_compute, "the finer level", ImageRange::mip(level - 1));
    out.pyramid = builder.write(out.pyramid, Access::storage_image_write, ImageRange::mip(level));
  }
  return out;
}

void DepthPyramid::record(CommandList& commands, const In& in, const Out& out) const {
  const uint32_t level = commands.step();
  shared::DepthPyramidPush push{};
  push.source_px = {in.width_px, in.height_px};
  if (level == 0) {
    push_depth(commands, in.depth, push);
  } else {
    push.depth = commands.sampled(out.pyramid);
    push.source_px = commands.size(out.pyramid, level - 1);
  }
  push.target = commands.storage(out.pyramid);
  push.target_px = commands.size(out.pyramid, level);
  commands.bind(level == 0 ? out.pipelines.first : out.pipelines.others);
  commands.push(push);
  commands.dispatch(push.target_px.x, push.target_px.y);
}

}  // namespace candela
