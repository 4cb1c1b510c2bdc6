#include "gpu_fixture.h"

namespace candela::gpu::test {

class Upload : public GpuTest {
 protected:
  // Copies a buffer or a level of a texture back to the host.
  std::vector<std::byte> copy_back(const std::function<void(VkCommandBuffer, VkBuffer)>& copy, uint64_t bytes) {
    Buffer target(*device, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, Buffer::Memory::host_read,
                  Device::Purpose::readback, "back");
    VkCommandPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, nullptr, 0, device->queue_family()};
    VkCommandPool pool;
    VK_CHECK(vkCreateCommandPool(device->handle(), &pool_info, nullptr, &pool));
    VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool, {}, 1};
    VkCommandBuffer commands;
    VK_CHECK(vkAllocateCommandBuffers(device->handle(), &info, &commands));
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    VK_CHECK(vkBeginCommandBuffer(commands, &begin));
    copy(commands, target.handle());
    VK_CHECK(vkEndCommandBuffer(commands));
    VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands;
    VK_CHECK(vkQueueSubmit(device->queue(), 1, &submit, VK_NULL_HANDLE));
    VK_CHECK(vkQueueWaitIdle(device->queue()));
    vkDestroyCommandPool(device->handle(), pool, nullptr);
    target.invalidate();
    return {target.mapped(), target.mapped() + bytes};
  }
  static std::vector<std::byte> noise(size_t bytes, uint32_t seed) {
    std::vector<std::byte> data(bytes);
    for (size_t i = 0; i < bytes; ++i) data[i] = std::byte(((i + seed) * 2654435761u) >> 24);
    return data;
  }
};

// More than the staging buffer holds, at an offset, among others that stay as they were.
TEST_F(Upload, BuffersLargerThanTheStagingBufferArriveWhole) {
  const std::vector<std::byte> data = noise((40 << 20) + 13, 1), head = noise(100, 2);
  Buffer buffer(*device, data.size() + 100, VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                Buffer::Memory::device, Device::Purpose::scene, "buffer");
  Uploader uploader(*device);
  uploader.to_buffer(buffer, 0, head);
  uploader.to_buffer(buffer, 100, data);
  uploader.flush();
  const auto back = copy_back(
      [&](VkCommandBuffer commands, VkBuffer target) {
        const VkBufferCopy region{0, 0, buffer.size()};
        vkCmdCopyBuffer(commands, buffer.handle(), target, 1, &region);
      },
      buffer.size());
  EXPECT_TRUE(std::equal(head.begin(), head.end(), back.begin()));
  EXPECT_TRUE(std::equal(data.begin(), data.end(), back.begin() + 100));
}

TEST_F(Upload, TextureLevelsAreSplitByRowsAndSampled) {
  TextureData data{VK_FORMAT_R8G8B8A8_UNORM, 3000, 2000, {}};
  for (uint32_t level = 0; level < 3; ++level)
    data.levels.push_back(noise((3000 >> level) * (2000 >> level) * 4, level));
  Texture texture(*device, data, "texture");
  Uploader uploader(*device);
  uploader.to_texture(texture, data);
  uploader.flush();
  const uint32_t sampled = bindless->add_sampled(texture.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);

  GraphBuilder builder;
  builder.begin_pass("sample");
  ImageHandle image = builder.create(
      ImageDesc{.name = "image", .format = VK_FORMAT_R32G32B32A32_SFLOAT, .width_px = 3000, .height_px = 2000});
  image = builder.write(image, Access::storage_image_write);
  const PipelineHandle pipeline = builder.pipeline(ComputePipelineDesc{.shader = "texture_to_image.comp"});
  builder.end_pass([=](CommandList& commands) {
    commands.bind(pipeline);
    commands.push(std::array<uint32_t, 4>{sampled, commands.storage(image), 3000, 2000});
    commands.dispatch(3000, 2000);
  });
  const BufferHandle bytes = add_readback(builder, "image", image, 3000 * 2000 * 16);
  const FrameRun result = run(compile_graph(builder));
  const auto texels = values_of<float>(*result.readbacks.at(bytes.resource));
  size_t wrong = 0;
  for (size_t i = 0; i < 3000 * 2000; ++i) wrong += std::lround(texels[i * 4] * 255) != int(data.levels[0][i * 4]);
  EXPECT_EQ(wrong, 0u);
  bindless->remove_sampled(sampled);
}

TEST_F(Upload, EqualSamplersShareAnIndexAndFreedImageIndicesComeBack) {
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  const uint32_t a = bindless->add_sampler(info);
  EXPECT_EQ(bindless->add_sampler(info), a);
  info.magFilter = VK_FILTER_LINEAR;
  EXPECT_NE(bindless->add_sampler(info), a);

  Texture texture(*device, {VK_FORMAT_R8G8B8A8_UNORM, 1, 1, {noise(4, 0)}}, "texel");
  const uint32_t first = bindless->add_sampled(texture.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  const uint32_t second = bindless->add_sampled(texture.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  EXPECT_NE(first, second);
  bindless->remove_sampled(first);
  EXPECT_EQ(bindless->add_sampled(texture.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL), first);
}

}  // namespace candela::gpu::test
