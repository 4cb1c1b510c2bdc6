#pragma once
#include "passes/lights/light_grid.h"
#include "passes_fixture.h"
#include "shared/scene.h"

namespace candela::gpu::test {

// A tile between two depths: tangents of its sides (orthographic: metres), and metres.
struct Slab {
  glm::vec2 low, high;
  float z_near, z_far;
};
struct SlabPair {
  LightItem light;
  Slab slab;
};

// What the bounding tests of shaders/lib/light_bounds.glsl say.
class LightBoundsTest : public PassTest {
 protected:
  // bits of the four tests for each pair. The slab is a tile's; view space is relative space here.
  std::vector<uint32_t> touches(const std::vector<SlabPair>& pairs, bool perspective) {
    shared::FrameConstants frame{};
    frame.camera_right = {1, 0, 0}, frame.camera_up = {0, 1, 0}, frame.camera_back = {0, 0, -1};
    frame.perspective = perspective;
    frame.size_px = {16, 16};
    frame.tan_half = {1e3f, 1e3f};  // everything is in view
    std::vector<LightItem> lights;
    std::vector<Slab> slabs;
    for (const SlabPair& p : pairs) lights.push_back(p.light), slabs.push_back(p.slab);
    std::vector<shared::LightBounds> bounds(pairs.size());
    const Buffer constants = upload(std::vector{frame}, "frame");
    for (size_t i = 0; i < pairs.size(); ++i) bounds[i] = inflated_bounds(pairs[i].light, frame);
    const Buffer bounds_buffer = upload(bounds, "bounds"), slab_buffer = upload(slabs, "slabs");
    GraphBuilder builder;
    const BufferHandle f = import(builder, constants, "frame"), b = import(builder, bounds_buffer, "bounds"),
                       s = import(builder, slab_buffer, "slabs");
    builder.begin_pass("touches");
    for (const BufferHandle handle : {f, b, s}) builder.read(handle, Access::compute_read, "input");
    const BufferHandle results = builder.write(
        builder.create(BufferDesc{.name = "results", .size_bytes = pairs.size() * 4}), Access::compute_write);
    const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "light_touches.comp"});
    builder.end_pass([=, count = uint32_t(pairs.size())](CommandList& commands) {
      struct {
        uint64_t frame, bounds, slabs, results;
        uint32_t count, padding;
      } const push{commands.address(f), commands.address(b), commands.address(s), commands.address(results), count, 0};
      commands.bind(pipeline);
      commands.push(push);
      commands.dispatch(count);
    });
    const BufferHandle words = read_words(builder, "results", results, pairs.size() * 4);
    const FrameRun run = run_all(builder);
    std::vector<uint32_t> bits(pairs.size());
    std::memcpy(bits.data(), run.readbacks.at(words.resource)->bytes().data(), bits.size() * 4);
    return bits;
  }
};

}  // namespace candela::gpu::test
