#include "passes/post/resolve.h"

#include "shared/draw.h"

namespace candela {

std::span<const Knob> ResolveKnobs::table() {
  static const Knob table[] = {
      {.name = "samples",
       .member = &ResolveKnobs::samples,
       .lowest = 1,
       .highest = 8,
       .levels = {1, 4},
       .description =
           "coverage and depth samples a pixel (1, 2, 4 or 8, as the device has them): edges against memory and time",
       .only = {1, 2, 4, 8},
       .required = "supersample.n=1"},
  };
  return table;
}

Need Resolve::needed(const SceneFacts&, const FrameRequest& request) const {
  return needed_if(request.samples > 1, "one sample a pixel needs no resolve");
}

Resolve::Out Resolve::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.color, Access::sampled_compute, "color");
  Out out;
  out.resolved = builder.write(builder.create(ImageDesc{"resolved", color_format, in.width_px, in.height_px}),
                               Access::storage_image_write);
  out.pipeline = builder.pipeline(ComputePipelineDesc{"resolve.comp", {{0, "SAMPLES", in.samples}}});
  return out;
}

void Resolve::record(CommandList& commands, const In& in, const Out& out) const {
  commands.bind(out.pipeline);
  shared::ResolvePush push{};
  push.source = commands.sampled(in.color);
  push.target = commands.storage(out.resolved);
  push.size_px = {in.width_px, in.height_px};
  commands.push(push);
  commands.dispatch_picture(in.width_px, in.height_px);
}

}  // namespace candela
