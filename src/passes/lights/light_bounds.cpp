#include "passes/lights/light_bounds.h"

#include "shared/lights.h"

namespace candela {

Need LightBoundsPass::needed(const SceneFacts&, const FrameRequest&) const {
  if (!grid.reason.empty()) return {false, grid.reason};
  return needed_if(grid.most_bounds > 0, "the host poses all lights");
}

LightBoundsPass::Out LightBoundsPass::declare(GraphBuilder& builder, const In& in) const {
  builder.read(in.scene.constants, Access::uniform_read, "the frame's constants");
  builder.read(in.scene.lights, Access::compute_read, "the scene's lights");
  const auto made = [&](const char* buffer, uint64_t bytes, bool zeroed) {
    // Boxes and chunks come in any order.
    return builder.write(
        builder.create(BufferDesc{.name = buffer, .size_bytes = bytes, .zeroed = zeroed, .unordered = !zeroed}),
        Access::compute_write);
  };
  Out out;
  out.boxes.bounds = made("light.bounds", uint64_t(grid.most_bounds) * sizeof(shared::LightBounds), false);
  out.boxes.chunks = made("light.chunks", uint64_t(grid.most_chunks) * sizeof(shared::LightChunk), false);
  out.boxes.dispatch = made("light.dispatch", sizeof(shared::LightDispatch), true);
  out.count = made("light.bounds_count", sizeof(uint32_t), true);
  ComputePipelineDesc desc{"light_bounds.comp", {}};
  if (grid.tiled) desc.constants.push_back({0, "TILED", 1});
  out.pipeline = builder.pipeline(desc);
  return out;
}

void LightBoundsPass::record(CommandList& commands, const In& in, const Out& out) const {
  shared::LightBoundsPush push{};
  push.lights = commands.address(in.scene.lights);
  push.bounds = commands.address(out.boxes.bounds);
  push.chunks = commands.address(out.boxes.chunks);
  push.dispatch = commands.address(out.boxes.dispatch);
  push.bounds_count = commands.address(out.count);
  push.light_count = in.scene.values->light_count;
  commands.bind(out.pipeline);
  commands.push(push);
  const glm::uvec2 threads = shared::light_threads(in.scene.values->light_count);
  commands.dispatch(threads.x, threads.y);
}

}  // namespace candela
