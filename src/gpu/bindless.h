#pragma once
#include <cstdint>

#include "gpu/device.h"
#include "gpu/pipeline_store.h"

namespace candela::gpu {

// The descriptor sets of shaders/lib/bindless.glsl, and the one pipeline layout: both sets, and 128 bytes of push
// constants visible to all stages.
//   set 0, update-after-bind and partially bound: binding 0 sampled textures of the scene, binding 1 samplers,
//   binding 2 the fixed samplers of graph images (shared/samplers.h)
//   set 1, one for each step of a plan's passes (Physical makes them): binding 0 sampled images of the graph, binding 1
//   storage images, binding 2 the pass's block of uniforms
class Bindless {
 public:
  static constexpr uint32_t most_textures = 16384;
  static constexpr uint32_t pass_sampled = 16, pass_storage = 8;  // images that one pass may sample, and store to
  static constexpr VkDescriptorPoolSize pass_sizes[] = {{VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, pass_sampled},
                                                        {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, pass_storage},
                                                        {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1}};  // of one set 1

  // textures: how many sampled images there will be at most. The set has room for the next power of two, so that few
  // layouts exist and pipeline caches serve most scenes; memory of unused descriptors still costs time.
  explicit Bindless(Device& device, uint32_t textures = most_textures);
  ~Bindless();
  uint32_t add_sampled(VkImageView view, VkImageLayout layout);
  uint32_t add_sampler(const VkSamplerCreateInfo& info);  // equal infos share an index; owned here
  void remove_sampled(uint32_t index);
  VkDescriptorSet set() const { return set_; }
  VkPipelineLayout layout() const { return layout_->handle; }
  VkDescriptorSetLayout pass_set_layout() const { return layout_->pass_set; }
  uint32_t room() const { return layout_->textures; }  // of the layout: pipelines of one room serve all sets of it

 private:
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
  Device& device_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  const PipelineLayout* layout_ = nullptr;  // the device's
};

}  // namespace candela::gpu
