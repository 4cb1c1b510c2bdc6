#include "passes/post/motion_blur.h"

#include "shared/motion_blur.h"

namespace candela {

std::span<const Knob> MotionBlur::Knobs::table() {
  static const Knob table[] = {
      {.name = "samples",
       .member = &Knobs::samples,
       .lowest = 2,
       .highest = 1024,
       .levels = {16, 16, 16, 128},
       .description = "lookups of a pixel along its motion; fewer show as noise",
       .sweep = {8, 16, 128},
       .required = "subframes.gather=1"},
      {.name = "most_px",
       .member = &Knobs::most_px,
       .unit = "px",
       .lowest = 4,
       .highest = 256,
       .levels = {32, 32, 32, 128},
       .description = "longest motion to either side of a pixel; longer is shortened",
       .sweep = {16, 32, 128},
       .required = "subframes.gather=1"},
  };
  return table;
}

Need MotionBlur::needed(const SceneFacts&, const FrameRequest& request) const {
  return needed_if(request.motion_share > 0, "no shutter is open, or subframes have it (--shutter, subframes.gather)");
}

MotionBlur::Out MotionBlur::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  const uint32_t side = uint32_t(knobs.most_px);
  const glm::uvec2 tiles((s.width_px + side - 1) / side, (s.height_px + side - 1) / side);
  builder.read(in.motion, Access::sampled_compute, "motion");
  Out out;
  const auto of_tiles = [&](const char* name) {
    return builder.create(
        ImageDesc{.name = name, .format = VK_FORMAT_R32G32_SFLOAT, .width_px = tiles.x, .height_px = tiles.y});
  };
  builder.begin_step();
  out.tiles = builder.write(of_tiles("motion.tiles"), Access::storage_image_write);
  out.pipelines[0] = builder.pipeline(ComputePipelineDesc{"motion_tiles.comp", {}});
  builder.begin_step();
  builder.read(out.tiles, Access::sampled_compute, "tiles");
  out.neighbours = builder.write(of_tiles("motion.neighbours"), Access::storage_image_write);
  out.pipelines[1] = builder.pipeline(ComputePipelineDesc{"motion_tiles.comp", {{0, "NEIGHBOURS", 1}}});
  builder.begin_step();
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  builder.read(in.color, Access::sampled_compute, "color");
  builder.read(out.neighbours, Access::sampled_compute, "neighbours");
  if (in.depth) read_depth(builder, in.depth);
  out.color = builder.write(builder.create(ImageDesc{"moved", color_format, s.width_px, s.height_px}),
                            Access::storage_image_write);
  out.pipelines[2] = builder.pipeline(ComputePipelineDesc{with_depth("motion_gather.comp", in.depth),
                                                          {{0, "DEPTH_SAMPLES", in.depth ? s.samples : 0}}});
  return out;
}

void MotionBlur::record(CommandList& commands, const In& in, const Out& out) const {
  const uint32_t step = commands.step();
  const glm::uvec2 tiles = commands.size(out.tiles);
  const glm::uvec2 size(in.scene.width_px, in.scene.height_px);
  commands.bind(out.pipelines[step]);
  // Half of it lies before the frame's time, half after it.
  const float share = 0.5f * *in.share;
  if (step < 2) {
    shared::MotionTilesPush push{};
    push.source = commands.sampled(step == 0 ? in.motion : out.tiles);
    push.target = commands.storage(step == 0 ? out.tiles : out.neighbours);
    push.size_px = size, push.tiles = tiles;
    push.side = uint32_t(knobs.most_px);
    push.share = share;
    commands.push(push);
    commands.dispatch(tiles.x, tiles.y);
    return;
  }
  shared::MotionGatherPush push{};
  push.color = commands.sampled(in.color);
  push.motion = commands.sampled(in.motion);
  push.neighbours = commands.sampled(out.neighbours);
  push_depth(commands, in.depth, push);
  push.target = commands.storage(out.color);
  push.size_px = size;
  push.side = uint32_t(knobs.most_px), push.samples = uint32_t(knobs.samples);
  push.share = share;
  push.seed = *in.seed;
  commands.push(push);
  commands.dispatch(size.x, size.y);
}

}  // namespace candela
