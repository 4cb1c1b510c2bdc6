#include <chrono>

#include "gpu_fixture.h"

namespace candela::gpu::test {

class PassTiming : public GpuTest {};

namespace {

constexpr uint32_t heavy_threads = 1 << 16;

void add_flat(GraphBuilder& builder, const std::string& name) {
  builder.begin_pass(name);
  ImageHandle image =
      builder.create(ImageDesc{.name = name, .format = VK_FORMAT_R16G16B16A16_SFLOAT, .width_px = 64, .height_px = 64});
  image = builder.write(image, Access::color_attachment);
  const PipelineHandle pipeline =
      builder.pipeline(GraphicsPipelineDesc{.vertex_shader = "fullscreen.vert",
                                            .fragment_shader = "flat.frag",
                                            .color_formats = {VK_FORMAT_R16G16B16A16_SFLOAT}});
  builder.end_pass([=](CommandList& commands) {
    const CommandList::Attachment color{image};
    commands.begin_rendering({&color, 1}, {});
    commands.bind(pipeline);
    commands.push(glm::vec4(1));
    commands.draw(3);
    commands.end_rendering();
  });
  builder.sink(image);
}

}  // namespace

// A driver may charge a dispatch to the pass behind it. The ratios hold on any device, since the
// heavy pass does many orders of magnitude more than its neighbours.
TEST_F(PassTiming, ChargesAHeavyDispatchToItsOwnPassAndSumsToTheWallTime) {
  GraphBuilder builder;
  add_flat(builder, "light before");
  builder.sink(add_hash(builder, "heavy", heavy_threads, device->info().is_cpu ? 20000 : 2000000));
  add_flat(builder, "light after");
  const CompiledGraph graph = compile_graph(builder);
  run(graph, {.timed = true});  // lavapipe compiles shaders at their first draw
  const auto start = std::chrono::steady_clock::now();
  const FrameRun result = runner->run(graph, {}, {.timed = true});
  const double wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  ASSERT_EQ(result.passes.size(), 3u);
  EXPECT_EQ(result.passes[1].name, "heavy");
  EXPECT_GT(result.passes[1].gpu_ms, 0.9 * result.frame_gpu_ms);
  EXPECT_NEAR(result.frame_gpu_ms, wall_ms, 0.05 * wall_ms);
  EXPECT_EQ(result.frame_gpu_ms, result.passes[0].gpu_ms + result.passes[1].gpu_ms + result.passes[2].gpu_ms);
}

TEST_F(PassTiming, AFrameThatTakesTooLongNamesThePassesNotFinished) {
  GraphBuilder builder;
  add_flat(builder, "light");
  builder.sink(add_hash(builder, "heavy", heavy_threads, device->info().is_cpu ? 10000 : 2000000));
  const CompiledGraph graph = compile_graph(builder);
  runner->timeout_s = 0.001;
  try {
    run(graph);
    FAIL() << "no timeout";
  } catch (const GpuError& error) {
    EXPECT_EQ(error.result, VK_TIMEOUT);
    EXPECT_NE(std::string(error.what()).find("heavy"), std::string::npos) << error.what();
  }
  runner->timeout_s = 600;
  EXPECT_NO_THROW(run(graph));  // the runner waits for what it gave up on, and goes on
}

}  // namespace candela::gpu::test
