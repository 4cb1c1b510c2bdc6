#pragma once
#include "gpu/bindless.h"
#include "gpu/pipelines.h"
#include "graph/plan.h"

namespace candela::gpu {

// Reads every sample of multisampled images by a compute shader, since they cannot be copied to buffers: for each pixel
// and sample as many 32-bit words as the format has channels.
class SampleReader {
 public:
  SampleReader(Device& device, Bindless& bindless, Pipelines& pipelines);
  ~SampleReader();
  SampleReader(const SampleReader&) = delete;
  SampleReader& operator=(const SampleReader&) = delete;
  static uint64_t bytes(const ImageDesc& desc);
  // The image is in SHADER_READ_ONLY_OPTIMAL, and what was recorded before has finished. Throws GpuError.
  void record(VkCommandBuffer commands, const ImageDesc& desc, VkImageView view, uint64_t target_address);

 private:
  Device& device_;
  Bindless& bindless_;
  Pipelines& pipelines_;
  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
};

}  // namespace candela::gpu
