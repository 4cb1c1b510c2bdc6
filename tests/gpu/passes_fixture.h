#pragma once
#include "base/rng.h"
#include "gpu_fixture.h"
#include "passes/shared/pass.h"

namespace candela::gpu::test {

// Runs passes of src/passes alone: their inputs come from the host, what they leave goes back to it.
class PassTest : public GpuTest {
 protected:
  // A buffer that the device reads in place.
  template <class T>
  Buffer upload(const std::vector<T>& values, const char* name) {
    Buffer buffer(*device, std::max<size_t>(values.size() * sizeof(T), 4),
                  VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                      VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                  Buffer::Memory::upload, Device::Purpose::scene, name);
    if (!values.empty()) std::memcpy(buffer.mapped(), values.data(), values.size() * sizeof(T));
    return buffer;
  }
  BufferHandle import(GraphBuilder& builder, const Buffer& buffer, const char* name) {
    const BufferHandle handle = builder.import_buffer(BufferDesc{.name = name, .size_bytes = buffer.size()});
    imports[handle.resource] = &buffer;
    return handle;
  }
  // Declares one pass of the project with its own recording.
  template <Pass P>
  typename P::Out add(GraphBuilder& builder, const P& pass, const typename P::In& in) {
    builder.begin_pass(std::string(P::name));
    const typename P::Out out = pass.declare(builder, in);
    EXPECT_TRUE(builder.end_pass([=](CommandList& commands) { pass.record(commands, in, out); }));
    return out;
  }
  BufferHandle read_words(GraphBuilder& builder, const std::string& name, BufferHandle source, uint64_t bytes) {
    builder.begin_pass(fmt::format("read back {} {}", name, builder.passes().size()));
    builder.read(source, Access::compute_read, name);
    BufferHandle target =
        builder.create(BufferDesc{.name = name + " words", .size_bytes = bytes, .memory = BufferMemory::host_read});
    target = builder.write(target, Access::compute_write);
    const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "copy_words.comp"});
    builder.end_pass([=](CommandList& commands) {
      struct {
        uint64_t source, target;
        uint32_t count;
      } const push{commands.address(source), commands.address(target), uint32_t(bytes / 4)};
      commands.bind(pipeline);
      commands.push(push);
      commands.dispatch(uint32_t(bytes / 4));
    });
    builder.sink(target);
    return target;
  }
  ImageHandle make_image(GraphBuilder& builder, BufferHandle texels, uint32_t width, uint32_t height) {
    builder.begin_pass("fill");
    builder.read(texels, Access::compute_read, "texels");
    ImageHandle image = builder.create(
        ImageDesc{.name = "source", .format = VK_FORMAT_R32G32B32A32_SFLOAT, .width_px = width, .height_px = height});
    image = builder.write(image, Access::storage_image_write);
    const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "texels_to_image.comp"});
    builder.end_pass([=](CommandList& commands) {
      struct {
        uint64_t source;
        uint32_t image, width, height;
      } const push{commands.address(texels), commands.storage(image), width, height};
      commands.bind(pipeline);
      commands.push(push);
      commands.dispatch(width, height);
    });
    return image;
  }
  FrameRun run_all(const GraphBuilder& builder) { return run(compile_graph(builder), {}, imports); }

  Imports imports;
};

}  // namespace candela::gpu::test
