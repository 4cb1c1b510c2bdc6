#include "gpu_fixture.h"

namespace candela::gpu::test {

// Frames submitted before the ones in front of them are collected.
class InFlight : public GpuTest {
 protected:
  struct Planned {
    CompiledGraph graph;
    BufferHandle source, bytes;
  };
  // A frame that copies the words of an import to what the host reads, through an image of `width` texels: frames in
  // flight share the image.
  Planned copy_frame(uint32_t width) {
    GraphBuilder builder;
    const BufferHandle source = builder.import_buffer(BufferDesc{.name = "source", .size_bytes = width * 16});
    builder.begin_pass("image");
    builder.read(source, Access::compute_read, "source");
    ImageHandle image = builder.create(
        ImageDesc{.name = "image", .format = VK_FORMAT_R32G32B32A32_SFLOAT, .width_px = width, .height_px = 1});
    image = builder.write(image, Access::storage_image_write);
    const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "texels_to_image.comp"});
    builder.end_pass([=](CommandList& commands) {
      struct {
        uint64_t source;
        uint32_t image, width, height;
      } const push{commands.address(source), commands.storage(image), width, 1};
      commands.bind(pipeline);
      commands.push(push);
      commands.dispatch(width);
    });
    const BufferHandle bytes = add_readback(builder, "image", image, width * 16);
    return {compile_graph(builder), source, bytes};
  }
  // A buffer of `width` texels that hold `value`.
  std::shared_ptr<Buffer> texels(uint32_t width, float value) {
    auto buffer = std::make_shared<Buffer>(
        *device, width * 16, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
        Buffer::Memory::upload, Device::Purpose::scene, "source");
    const std::vector<glm::vec4> values(width, glm::vec4(value));
    std::memcpy(buffer->mapped(), values.data(), values.size() * sizeof values[0]);
    return buffer;
  }
  FrameTicket submit(const Planned& planned, const std::shared_ptr<Buffer>& source, const RunOptions& options = {}) {
    const auto prepared = runner->prepare(planned.graph);
    EXPECT_TRUE(prepared) << prepared.error().text();
    return runner->submit(planned.graph, {{planned.source.resource, source.get()}}, options, {source});
  }
  void expect_texels(const Planned& planned, const FrameRun& run, uint32_t width, float value) {
    const std::vector<glm::vec4> wanted(width, glm::vec4(value));
    EXPECT_EQ(values_of<glm::vec4>(*run.readbacks.at(planned.bytes.resource)), wanted);
  }
  // Work of about a second, so that it is surely not done while the next frames are submitted.
  CompiledGraph heavy_frame(uint32_t rounds) {
    GraphBuilder builder;
    const BufferHandle words = add_hash(builder, "heavy", 1 << 16, rounds);
    builder.sink(words);
    return compile_graph(builder);
  }
  uint32_t heavy_rounds() const { return device->info().is_cpu ? 40000 : 8000000; }
};

TEST_F(InFlight, EachFrameHasItsOwnUploadsAndReadbacks) {
  constexpr uint32_t width = 64;
  const Planned planned = copy_frame(width);
  for (const size_t most : {1u, 2u, 3u}) {
    std::vector<std::pair<FrameTicket, float>> waiting;
    const auto collect_first = [&] {
      expect_texels(planned, runner->collect(waiting.front().first), width, waiting.front().second);
      waiting.erase(waiting.begin());
    };
    for (int frame = 0; frame < 7; ++frame) {
      waiting.emplace_back(submit(planned, texels(width, float(frame))), float(frame));
      if (waiting.size() == most) collect_first();
    }
    while (!waiting.empty()) collect_first();
  }
}

TEST_F(InFlight, FramesMayBeCollectedInAnyOrder) {
  constexpr uint32_t width = 16;
  const Planned planned = copy_frame(width);
  const FrameTicket a = submit(planned, texels(width, 1)), b = submit(planned, texels(width, 2)),
                    c = submit(planned, texels(width, 3));
  expect_texels(planned, runner->collect(b), width, 2);
  expect_texels(planned, runner->collect(c), width, 3);
  expect_texels(planned, runner->collect(a), width, 1);
}

TEST_F(InFlight, WhatAFrameReadsIsKeptUntilItIsDone) {
  const Planned planned = copy_frame(8);
  auto source = texels(8, 1);
  const std::weak_ptr<Buffer> watched = source;
  const FrameTicket ticket = submit(planned, source);
  source.reset();
  EXPECT_FALSE(watched.expired());
  expect_texels(planned, runner->collect(ticket), 8, 1);
  EXPECT_TRUE(watched.expired());
}

// The new plan's images are made while the old plan's frame runs, and the old ones go when it is done.
TEST_F(InFlight, AChangeOfPlanDoesNotWaitForTheFramesBeforeIt) {
  const CompiledGraph heavy = heavy_frame(heavy_rounds());
  ASSERT_TRUE(runner->prepare(heavy));
  const auto kept = std::make_shared<int>();
  const FrameTicket first = runner->submit(heavy, {}, {}, {kept});
  const Planned narrow = copy_frame(8), wide = copy_frame(64);
  const FrameTicket second = submit(narrow, texels(8, 2)), third = submit(wide, texels(64, 3));
  EXPECT_EQ(kept.use_count(), 2) << "the heavy frame was waited for";
  const uint64_t all_plans = device->memory_use().frame;
  runner->collect(first);
  EXPECT_EQ(kept.use_count(), 1);
  EXPECT_LT(device->memory_use().frame, all_plans) << "the heavy frame's buffer outlives it";
  expect_texels(narrow, runner->collect(second), 8, 2);
  expect_texels(wide, runner->collect(third), 64, 3);
  run(wide.graph, {}, {{wide.source.resource, texels(64, 4).get()}});
  const uint64_t of_wide = device->memory_use().frame;
  // Plans that take turns keep what they have, beside each other; a third has its own alone.
  uint64_t of_both = 0;
  for (int frame = 0; frame < 4; ++frame) {
    const FrameTicket a = submit(narrow, texels(8, 5)), b = submit(wide, texels(64, 6));
    expect_texels(narrow, runner->collect(a), 8, 5);
    expect_texels(wide, runner->collect(b), 64, 6);
    if (frame == 0) of_both = device->memory_use().frame;
    EXPECT_EQ(device->memory_use().frame, of_both);
  }
  EXPECT_GT(of_both, of_wide);
  const Planned third_plan = copy_frame(16);
  run(third_plan.graph, {}, {{third_plan.source.resource, texels(16, 7).get()}});
  EXPECT_LT(device->memory_use().frame, of_wide);
}

// Timing and hashing need the device for themselves, and the frames before them keep what they left.
TEST_F(InFlight, TimedAndHashedRunsWaitForTheFramesBefore) {
  const Planned planned = copy_frame(32);
  for (const RunOptions& options : {RunOptions{.timed = true}, RunOptions{.hash_outputs = true}}) {
    const FrameTicket before = submit(planned, texels(32, 1)), alone = submit(planned, texels(32, 2), options),
                      after = submit(planned, texels(32, 3));
    const FrameRun result = runner->collect(alone);
    expect_texels(planned, result, 32, 2);
    EXPECT_EQ(result.passes.size(), options.timed ? 2u : 0u);
    EXPECT_EQ(result.hashes.size(), options.hash_outputs ? 2u : 0u);
    expect_texels(planned, runner->collect(before), 32, 1);
    expect_texels(planned, runner->collect(after), 32, 3);
  }
}

// What failed is the frame whose collect throws; those beside it are whole.
TEST_F(InFlight, AnErrorBelongsToItsFrame) {
  const Planned planned = copy_frame(16);
  const CompiledGraph heavy = heavy_frame(heavy_rounds());
  const FrameTicket before = submit(planned, texels(16, 1));
  ASSERT_TRUE(runner->prepare(heavy));
  const auto kept = std::make_shared<int>();
  const FrameTicket failing = runner->submit(heavy, {}, {}, {kept});
  runner->timeout_s = 0.001;
  try {
    runner->collect(failing);
    FAIL() << "no timeout";
  } catch (const GpuError& error) {
    EXPECT_EQ(error.result, VK_TIMEOUT);
    EXPECT_NE(std::string(error.what()).find("heavy"), std::string::npos) << error.what();
  }
  EXPECT_EQ(kept.use_count(), 2) << "the device may still use it";
  runner->timeout_s = 600;
  expect_texels(planned, runner->collect(before), 16, 1);
  expect_texels(planned, runner->collect(submit(planned, texels(16, 3))), 16, 3);
  EXPECT_EQ(kept.use_count(), 1);
}

// run() too: what a warm-up draws into stays until the device is done with it.
TEST_F(InFlight, WhatARunThatEndsLateUsesIsKept) {
  const CompiledGraph heavy = heavy_frame(heavy_rounds());
  ASSERT_TRUE(runner->prepare(heavy));
  const auto kept = std::make_shared<int>();
  runner->timeout_s = 0.001;
  try {
    runner->run(heavy, {}, {}, {kept});
    FAIL() << "no timeout";
  } catch (const GpuError& error) {
    EXPECT_EQ(error.result, VK_TIMEOUT);
  }
  EXPECT_EQ(kept.use_count(), 2) << "the device may still use it";
  runner->timeout_s = 600;
  const Planned planned = copy_frame(16);
  expect_texels(planned, runner->collect(submit(planned, texels(16, 1))), 16, 1);
  EXPECT_EQ(kept.use_count(), 1);
}

}  // namespace candela::gpu::test
