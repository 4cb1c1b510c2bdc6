#include "gpu/sample_reader.h"

#include "gpu/frame_runner.h"
#include "graph/formats.h"
#include "shared/hash.h"

namespace candela::gpu {

SampleReader::SampleReader(Device& device, Bindless& bindless, Pipelines& pipelines)
    : device_(device), bindless_(bindless), pipelines_(pipelines) {
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.maxSets = 1;
  pool.poolSizeCount = uint32_t(std::size(Bindless::pass_sizes));
  pool.pPoolSizes = Bindless::pass_sizes;
  VK_CHECK(vkCreateDescriptorPool(device.handle(), &pool, nullptr, &pool_));
  const VkDescriptorSetLayout layout = bindless.pass_set_layout();
  VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  info.descriptorPool = pool_;
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VK_CHECK(vkAllocateDescriptorSets(device.handle(), &info, &set_));
  device.set_name(VK_OBJECT_TYPE_DESCRIPTOR_SET, uint64_t(set_), "hash samples");
}

SampleReader::~SampleReader() { vkDestroyDescriptorPool(device_.handle(), pool_, nullptr); }

uint64_t SampleReader::bytes(const ImageDesc& desc) {
  return uint64_t(desc.width_px) * desc.height_px * desc.samples * format_channels(desc.format) * sizeof(uint32_t);
}

void SampleReader::record(VkCommandBuffer commands, const ImageDesc& desc, VkImageView view, uint64_t target_address) {
  const bool is_unsigned = format_name(desc.format).ends_with("UINT");
  const PipelineDesc wanted = ComputePipelineDesc{
      "hash_samples.comp",
      {{0, "SAMPLES", desc.samples}, {1, "CHANNELS", format_channels(desc.format)}, {2, "UNSIGNED", is_unsigned}}};
  PrepareTimes unused;
  const auto made = pipelines_.get({&wanted, 1}, unused);
  if (!made) throw GpuError(VK_ERROR_INITIALIZATION_FAILED, made.error().text());
  const Pipeline& pipeline = *made->front();

  const VkDescriptorImageInfo image{VK_NULL_HANDLE, view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
  const VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, nullptr, set_, 0, 0, 1,
                                   VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE,       &image};
  vkUpdateDescriptorSets(device_.handle(), 1, &write, 0, nullptr);
  const VkDescriptorSet sets[] = {bindless_.set(), set_};
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, bindless_.layout(), 0, 2, sets, 0, nullptr);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.handle);
  const shared::HashSamplesPush push{target_address, {desc.width_px, desc.height_px}};
  vkCmdPushConstants(commands, bindless_.layout(), VK_SHADER_STAGE_ALL, 0, sizeof push, &push);
  const auto groups = [](uint32_t threads, uint32_t size) { return (threads + size - 1) / size; };
  vkCmdDispatch(commands, groups(desc.width_px, pipeline.workgroup[0]), groups(desc.height_px, pipeline.workgroup[1]),
                1);
}

}  // namespace candela::gpu
