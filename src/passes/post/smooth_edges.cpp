#include "passes/post/smooth_edges.h"

#include "passes/shared/scene_inputs.h"
#include "shared/smooth_edges.h"

namespace candela {

std::span<const Knob> SmoothEdges::Knobs::table() {
  static const Knob table[] = {
      {.name = "method",
       .member = &Knobs::method,
       .lowest = 0,
       .highest = 1,
       .levels = {shape},
       .description = "shape: by the lines that edges stand for; contrast: what looks like an edge is softened, with "
                      "fewer reads and more left, most of all at long edges",
       .choices = {"shape", "contrast"},
       .sweep = {contrast, shape},
       .required = "smooth_edges.reach_px=32"},
      {.name = "reach_px",
       .member = &Knobs::reach_px,
       .unit = "px",
       .lowest = 0,
       .highest = 128,
       .levels = {0},
       .description =
           "how far along an edge its ends are searched, for pictures of one sample a pixel; 0: edges are not smoothed",
       .sweep = {8, 32, 0}},
      {.name = "threshold",
       .member = &Knobs::threshold,
       .lowest = 0.01,
       .highest = 1,
       .levels = {0.1},
       .description = "difference in shown luminance (x / (1 + x)) of the two sides that makes an edge",
       .sweep = {0.2, 0.05, 0.1},
       .required = "smooth_edges.reach_px=32"},
  };
  return table;
}

Need SmoothEdges::needed(const SceneFacts&, const FrameRequest& request) const {
  if (request.samples > 1) return {false, "pixels have several samples"};
  if (request.part.role != SubframePart::Role::whole) return {false, "the picture's frames are its samples"};
  return needed_if(knobs.reach_px > 0, "edges stay as they are (smooth_edges.reach_px)");
}

SmoothEdges::Out SmoothEdges::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.color, Access::sampled_compute, "color");
  const auto image = [&](const char* name, VkFormat format) {
    return builder.create(
        ImageDesc{.name = name, .format = format, .width_px = in.width_px, .height_px = in.height_px});
  };
  const auto pipeline = [&](uint32_t step) {
    return builder.pipeline(ComputePipelineDesc{"smooth_edges.comp", {{0, "STEP", step}}});
  };
  Out out;
  if (knobs.method == Knobs::contrast) {
    out.color = builder.write(image("edges.smooth", color_format), Access::storage_image_write);
    out.pipelines[0] = pipeline(3);
    return out;
  }
  builder.begin_step();
  out.edges = builder.write(image("edges", VK_FORMAT_R8G8_UNORM), Access::storage_image_write);
  out.pipelines[0] = pipeline(0);
  builder.begin_step();
  builder.read(out.edges, Access::sampled_compute, "edges");
  out.parts = builder.write(image("edges.parts", VK_FORMAT_R16G16B16A16_SFLOAT), Access::storage_image_write);
  out.pipelines[1] = pipeline(1);
  builder.begin_step();
  builder.read(out.parts, Access::sampled_compute, "parts");
  out.color = builder.write(image("edges.smooth", color_format), Access::storage_image_write);
  out.pipelines[2] = pipeline(2);
  return out;
}

void SmoothEdges::record(CommandList& commands, const In& in, const Out& out) const {
  const uint32_t step = commands.step();
  const bool last = knobs.method == Knobs::contrast || step == 2;
  commands.bind(out.pipelines[step]);
  shared::SmoothEdgesPush push{};
  push.color = commands.sampled(in.color);
  if (step > 0) push.source = commands.sampled(step == 1 ? out.edges : out.parts);
  push.target = commands.storage(last ? out.color : step == 0 ? out.edges : out.parts);
  push.size_px = {in.width_px, in.height_px};
  push.reach_px = uint32_t(knobs.reach_px);
  push.threshold = knobs.threshold;
  push.exposure = *in.exposure;
  commands.push(push);
  commands.dispatch(in.width_px, in.height_px);
}

}  // namespace candela
