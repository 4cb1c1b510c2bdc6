#include "passes/post/supersample.h"

#include "shared/draw.h"

namespace candela {

std::span<const Knob> SupersampleKnobs::table() {
  static const Knob table[] = {
      {.name = "n",
       .member = &SupersampleKnobs::n,
       .lowest = 1,
       .highest = 8,
       .levels = {1, 1, 1, 4},
       .description =
           "n x n samples a pixel of position, texture and shading instead of multisampling: the time of n x n frames",
       .sweep = {1, 2, 4}},
      {.name = "rows",
       .member = &SupersampleKnobs::rows,
       .lowest = 0,
       .highest = 8,
       .levels = {},
       .description = "rows of those samples, beside n columns: 4 by 2 are eight; 0: as many as columns",
       .sweep = {2, 0},
       .required = "supersample.n=4"},
  };
  return table;
}

Need Supersample::needed(const SceneFacts&, const FrameRequest&) const {
  return needed_if(knobs.pictures() > 1, "one sample of shading a pixel (supersample.n)");
}

Supersample::Out Supersample::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.color, Access::sampled_compute, "color");
  const bool adds = builder.read_optional(in.before, Access::sampled_compute);
  Out out;
  out.sum = builder.write(builder.create(ImageDesc{"supersampled", color_format, in.width_px, in.height_px}),
                          Access::storage_image_write);
  ComputePipelineDesc desc{"supersample.comp", {}};
  if (adds) desc.constants.push_back({0, "ADDS", 1});
  out.pipeline = builder.pipeline(desc);
  return out;
}

void Supersample::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::SupersamplePush push{};
  push.source = commands.sampled(in.color);
  push.before = in.before ? commands.sampled(in.before) : 0;
  push.target = commands.storage(out.sum);
  push.fraction = 1.0f / float(knobs.pictures());
  push.size_px = {in.width_px, in.height_px};
  commands.push(push);
  commands.dispatch_picture(in.width_px, in.height_px);
}

}  // namespace candela
