#include "passes/post/vignette.h"

namespace candela {

std::span<const Knob> Vignette::Knobs::table() {
  static const Knob table[] = {
      {.name = "strength",
       .member = &Knobs::strength,
       .lowest = 0,
       .highest = 1,
       .description = "how much of the light a corner loses; 0 leaves the pass out",
       .kind = Trades::look},
      {.name = "power",
       .member = &Knobs::power,
       .lowest = 0.5,
       .highest = 8,
       .description = "the larger, the nearer to the corners",
       .kind = Trades::look},
  };
  return table;
}

Need Vignette::needed(const SceneFacts&, const FrameRequest&) const {
  return needed_if(knobs.strength > 0, "vignette.strength is 0");
}

Vignette::Out Vignette::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.linear, Access::sampled_compute, "the linear picture");
  Out out;
  const auto image = [&](const char* image_name) {
    const ImageDesc desc{image_name, VK_FORMAT_R32G32B32A32_SFLOAT, in.width_px, in.height_px};
    return builder.write(builder.create(desc), Access::storage_image_write);
  };
  out.color = image("vignette.color");
  out.left = image("vignette.left");
  builder.publish("vignette", out.left);
  out.pipeline = builder.pipeline(ComputePipelineDesc{"vignette.comp"});
  return out;
}

void Vignette::record(CommandList& commands, const In& in, const Out& out) const {
  struct {
    uint32_t source, color, left, width_px, height_px;
    float strength, power;
  } const push{commands.sampled(in.linear),
               commands.storage(out.color),
               commands.storage(out.left),
               in.width_px,
               in.height_px,
               knobs.strength,
               knobs.power};
  commands.bind(out.pipeline);
  commands.push(push);
  commands.dispatch(in.width_px, in.height_px);
}

}  // namespace candela
