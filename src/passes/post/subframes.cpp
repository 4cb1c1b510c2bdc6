#include "passes/post/subframes.h"

#include "shared/draw.h"

namespace candela {

std::span<const Knob> SubframesKnobs::table() {
  static const Knob table[] = {
      {.name = "n",
       .member = &SubframesKnobs::n,
       .lowest = 1,
       .highest = 4096,
       .levels = {4, 8, 16, 256},
       .description = "frames averaged for a picture with a shutter or a lens (--subframes); the time grows with them",
       .sweep = {4, 16, 256}},
      {.name = "gather",
       .member = &SubframesKnobs::gather,
       .lowest = 0,
       .highest = 1,
       .levels = {1, 0, 0, 0},
       .description = "a shutter without a lens blurs one frame along the motion of its surfaces (motion_blur)",
       .sweep = {1, 0}},
  };
  return table;
}

Need Subframes::needed(const SceneFacts&, const FrameRequest& request) const {
  if (request.part.role == SubframePart::Role::mean) return {false, "the frames of the picture have done so"};
  return needed_if(request.part.role == SubframePart::Role::subframe,
                   "one moment through a pinhole (--shutter and --fstop, or a look's shutter and lens)");
}

Subframes::Out Subframes::declare(GraphBuilder& builder, const In& in) const {
  ComputePipelineDesc desc{"subframes.comp", {}};
  if (builder.read_optional(in.color, Access::sampled_compute)) desc.constants.push_back({0, "HAS_COLOR", 1});
  builder.read(in.before, Access::compute_read, "sum");
  return {builder.write(in.sum, Access::compute_write), builder.pipeline(desc)};
}

void Subframes::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::SubframesPush push{};
  push.before = commands.address(in.before), push.sum = commands.address(out.sum);
  push.source = in.color ? commands.sampled(in.color) : 0;
  push.fraction = 1.0f / float(in.count);
  push.first_px = in.first_px;
  push.size_px = {in.width_px, in.height_px};
  push.adds = *in.index > 0;
  commands.push(push);
  commands.dispatch(in.width_px, in.height_px);
}

Need SubframesMean::needed(const SceneFacts&, const FrameRequest& request) const {
  return needed_if(request.part.role == SubframePart::Role::mean, "the picture is one frame");
}

SubframesMean::Out SubframesMean::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.sum, Access::compute_read, "sum");
  Out out;
  out.color = builder.write(builder.create(ImageDesc{"mean", color_format, in.width_px, in.height_px}),
                            Access::storage_image_write);
  out.pipeline = builder.pipeline(ComputePipelineDesc{"subframes_mean.comp", {}});
  return out;
}

void SubframesMean::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::SubframesMeanPush push{};
  push.sum = commands.address(in.sum);
  push.target = commands.storage(out.color);
  push.size_px = {in.width_px, in.height_px};
  commands.push(push);
  commands.dispatch(in.width_px, in.height_px);
}

}  // namespace candela
