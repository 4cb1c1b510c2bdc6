#pragma once
#include <cstdint>

#include "gpu/device.h"

namespace candela::gpu {

// The one descriptor set (set 0), update-after-bind and partially bound, as shaders/lib/bindless.glsl declares it:
//   binding 0: sampled images (texture2D, utexture2D and texture2DMS alias it)   binding 1: samplers   binding 2: storage images
// and the one pipeline layout: this set and 128 bytes of push constants visible to all stages.
class Bindless {
 public:
  explicit Bindless(Device& device);
  ~Bindless();
  uint32_t add_sampled(VkImageView view, VkImageLayout layout);
  uint32_t add_sampler(const VkSamplerCreateInfo& info);  // equal infos share an index; owned here
  uint32_t add_storage(VkImageView view);
  void remove_sampled(uint32_t index);
  void remove_storage(uint32_t index);
  VkDescriptorSet set() const { return set_; }
  VkPipelineLayout layout() const { return layout_; }
  VkDescriptorSetLayout set_layout() const { return set_layout_; }

 private:
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
  Device& device_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
};

}  // namespace candela::gpu
