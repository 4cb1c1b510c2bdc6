#include "gpu/bindless.h"

#include <algorithm>
#include <array>
#include <bit>
#include <mutex>
#include <vector>

#include "base/check.h"
#include "shared/samplers.h"

namespace candela::gpu {

namespace {
constexpr uint32_t least_textures = 256, max_samplers = 512;

// Indices in use; the lowest free one is given out first, so that equal jobs get equal indices.
class Slots {
 public:
  explicit Slots(uint32_t capacity) : used_(capacity, false) {}
  uint32_t take(const char* what) {
    const auto found = std::find(used_.begin() + first_free_, used_.end(), false);
    if (found == used_.end())
      throw GpuError(VK_ERROR_OUT_OF_POOL_MEMORY, fmt::format("more than {} {}", used_.size(), what));
    *found = true;
    first_free_ = uint32_t(found - used_.begin()) + 1;
    return first_free_ - 1;
  }
  void give(uint32_t index) {
    CHECK(index < used_.size() && used_[index]);
    used_[index] = false;
    first_free_ = std::min(first_free_, index);
  }
  uint32_t capacity() const { return uint32_t(used_.size()); }

 private:
  std::vector<bool> used_;
  uint32_t first_free_ = 0;
};

bool equal(const VkSamplerCreateInfo& a, const VkSamplerCreateInfo& b) {
  const auto key = [](const VkSamplerCreateInfo& s) {
    return std::tie(s.flags, s.magFilter, s.minFilter, s.mipmapMode, s.addressModeU, s.addressModeV, s.addressModeW,
                    s.mipLodBias, s.anisotropyEnable, s.maxAnisotropy, s.compareEnable, s.compareOp, s.minLod, s.maxLod,
                    s.borderColor, s.unnormalizedCoordinates);
  };
  return key(a) == key(b);
}
}  // namespace

struct Bindless::Hidden {
  Slots sampled{least_textures};
  VkDescriptorPool pool = VK_NULL_HANDLE;
  std::vector<std::pair<VkSamplerCreateInfo, VkSampler>> samplers;
  std::mutex mutex;
};

Bindless::Bindless(Device& device, uint32_t textures) : hidden_(std::make_unique<Hidden>()), device_(device) {
  VkPhysicalDeviceVulkan12Properties v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &v12};
  vkGetPhysicalDeviceProperties2(device.physical(), &properties);
  const uint32_t room = std::bit_ceil(std::clamp(textures, least_textures, most_textures));
  const uint32_t counts[] = {std::min(room, v12.maxPerStageDescriptorUpdateAfterBindSampledImages),
                             std::min(max_samplers, v12.maxPerStageDescriptorUpdateAfterBindSamplers)};
  hidden_->sampled = Slots(counts[0]);
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, counts[0]},
                                        {VK_DESCRIPTOR_TYPE_SAMPLER, counts[1]},
                                        {VK_DESCRIPTOR_TYPE_SAMPLER, SAMPLER_COUNT}};
  layout_ = &device.store().layout(counts[0], counts[1]);

  VkDescriptorPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool_info.flags = VK_DESCRIPTOR_POOL_CREATE_UPDATE_AFTER_BIND_BIT;
  pool_info.maxSets = 1;
  pool_info.poolSizeCount = uint32_t(std::size(sizes));
  pool_info.pPoolSizes = sizes;
  VK_CHECK(vkCreateDescriptorPool(device.handle(), &pool_info, nullptr, &hidden_->pool));
  VkDescriptorSetAllocateInfo set_info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  set_info.descriptorPool = hidden_->pool;
  set_info.descriptorSetCount = 1;
  set_info.pSetLayouts = &layout_->set;
  VK_CHECK(vkAllocateDescriptorSets(device.handle(), &set_info, &set_));

  device.set_name(VK_OBJECT_TYPE_DESCRIPTOR_SET, uint64_t(set_), "bindless");
  device.set_name(VK_OBJECT_TYPE_PIPELINE_LAYOUT, uint64_t(layout_->handle), "bindless");
}

Bindless::~Bindless() {
  for (const auto& [info, sampler] : hidden_->samplers) vkDestroySampler(device_.handle(), sampler, nullptr);
  vkDestroyDescriptorPool(device_.handle(), hidden_->pool, nullptr);
}

namespace {
void write_descriptor(VkDevice device, VkDescriptorSet set, uint32_t binding, VkDescriptorType type, uint32_t index,
                      const VkDescriptorImageInfo& info) {
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET, nullptr, set, binding, index, 1, type, &info};
  vkUpdateDescriptorSets(device, 1, &write, 0, nullptr);
}
}  // namespace

uint32_t Bindless::add_sampled(VkImageView view, VkImageLayout layout) {
  std::lock_guard lock(hidden_->mutex);
  const uint32_t index = hidden_->sampled.take("sampled images");
  write_descriptor(device_.handle(), set_, 0, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, index, {VK_NULL_HANDLE, view, layout});
  return index;
}

uint32_t Bindless::add_sampler(const VkSamplerCreateInfo& info) {
  CHECK(info.pNext == nullptr);
  std::lock_guard lock(hidden_->mutex);
  auto& samplers = hidden_->samplers;
  for (uint32_t i = 0; i < samplers.size(); ++i)
    if (equal(samplers[i].first, info)) return i;
  if (samplers.size() >= max_samplers)
    throw GpuError(VK_ERROR_OUT_OF_POOL_MEMORY, fmt::format("more than {} samplers", max_samplers));
  VkSampler sampler = VK_NULL_HANDLE;
  VK_CHECK(vkCreateSampler(device_.handle(), &info, nullptr, &sampler));
  samplers.emplace_back(info, sampler);
  const uint32_t index = uint32_t(samplers.size()) - 1;
  write_descriptor(device_.handle(), set_, 1, VK_DESCRIPTOR_TYPE_SAMPLER, index,
                   {sampler, VK_NULL_HANDLE, VK_IMAGE_LAYOUT_UNDEFINED});
  return index;
}

void Bindless::remove_sampled(uint32_t index) {
  std::lock_guard lock(hidden_->mutex);
  hidden_->sampled.give(index);
}
}  // namespace candela::gpu
