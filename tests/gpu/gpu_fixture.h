#pragma once
#include <gtest/gtest.h>

#include <cstring>

#include "gpu/command_list.h"
#include "gpu/device.h"
#include "gpu/frame_runner.h"
#include "graph/builder.h"

namespace candela::gpu::test {

inline std::filesystem::path shader_folder() { return CANDELA_SOURCE_DIR "/tests/gpu/shaders"; }

// Opens the device with validation and synchronization checks; any message fails the test.
class GpuTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = Device::open({.which = "", .validate = true});
    ASSERT_TRUE(opened) << opened.error().text();
    device = std::move(*opened);
    bindless = std::make_unique<Bindless>(*device);
    runner = std::make_unique<FrameRunner>(*device, *bindless, glsl::ShaderCompiler(shader_folder()),
                                           std::filesystem::path{});
  }
  void TearDown() override {
    runner.reset();
    bindless.reset();
    if (!device) return;
    for (const std::string& message : device->validation_messages()) ADD_FAILURE() << message;
  }

  FrameRun run(const CompiledGraph& graph, const RunOptions& options = {}, const Imports& imports = {}) {
    const auto prepared = runner->prepare(graph);
    EXPECT_TRUE(prepared) << prepared.error().text();
    return prepared ? runner->run(graph, imports, options) : FrameRun{};
  }

  std::unique_ptr<Device> device;
  std::unique_ptr<Bindless> bindless;
  std::unique_ptr<FrameRunner> runner;
};

template <class T>
std::vector<T> values_of(const Readback& readback) {
  std::vector<T> values(readback.bytes().size() / sizeof(T));
  std::memcpy(values.data(), readback.bytes().data(), values.size() * sizeof(T));
  return values;
}

// Common pieces of the test graphs. Each declares one pass.
struct FillPush {
  uint32_t image, width, height, value;
};
inline ImageHandle add_fill(GraphBuilder& builder, const std::string& name, uint32_t width, uint32_t height,
                            float value) {
  builder.begin_pass("fill " + name);
  ImageHandle image = builder.create(
      ImageDesc{.name = name, .format = VK_FORMAT_R32G32B32A32_SFLOAT, .width_px = width, .height_px = height});
  image = builder.write(image, Access::storage_image_write);
  const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "fill.comp"});
  builder.end_pass([=](CommandList& commands) {
    commands.bind(pipeline);
    commands.push(FillPush{commands.storage(image), width, height, std::bit_cast<uint32_t>(value)});
    commands.dispatch(width, height);
  });
  return image;
}

// `threads` threads of `rounds` rounds of a hash each; a word of each.
inline BufferHandle add_hash(GraphBuilder& builder, const std::string& name, uint32_t threads, uint32_t rounds,
                             Queue queue = Queue::main) {
  builder.begin_pass(name, queue);
  BufferHandle words = builder.create(BufferDesc{.name = name + " words", .size_bytes = uint64_t(threads) * 4});
  words = builder.write(words, Access::compute_write);
  const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "heavy.comp"});
  builder.end_pass([=](CommandList& commands) {
    struct {
      uint64_t target;
      uint32_t rounds, unused;
    } const push{commands.address(words), rounds, 0};
    commands.bind(pipeline);
    commands.push(push);
    commands.dispatch(threads);
  });
  return words;
}

inline BufferHandle add_readback(GraphBuilder& builder, const std::string& name, ImageHandle image, uint64_t bytes) {
  builder.begin_pass(fmt::format("read back {} {}", name, builder.passes().size()));
  builder.read(image, Access::transfer_source, name);
  BufferHandle buffer =
      builder.create(BufferDesc{.name = name + " bytes", .size_bytes = bytes, .memory = BufferMemory::host_read});
  buffer = builder.write(buffer, Access::transfer_destination);
  builder.end_pass([=](CommandList& commands) { commands.copy_to_buffer(image, buffer); });
  builder.sink(buffer);
  return buffer;
}

}  // namespace candela::gpu::test
