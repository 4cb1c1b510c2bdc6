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

namespace {
// In the order of shared/samplers.h.
VkSamplerCreateInfo graph_sampler(uint32_t which) {
  const bool shadow = which == SAMPLER_SHADOW_LINEAR || which == SAMPLER_SHADOW_NEAREST;
  const bool linear = which == SAMPLER_LINEAR_CLAMP || which == SAMPLER_LINEAR_REPEAT || which == SAMPLER_SHADOW_LINEAR;
  const bool repeat = which == SAMPLER_LINEAR_REPEAT || which == SAMPLER_NEAREST_REPEAT;
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = info.minFilter = linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
  info.mipmapMode = linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST;
  info.addressModeU = info.addressModeV = info.addressModeW =
      repeat ? VK_SAMPLER_ADDRESS_MODE_REPEAT : VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.compareEnable = shadow;
  info.compareOp = VK_COMPARE_OP_GREATER_OR_EQUAL;
  info.maxLod = VK_LOD_CLAMP_NONE;
  return info;
}

// One binding for each size, in order; a last one of samplers that never change where there are any.
VkDescriptorSetLayout make_set_layout(Device& device, std::span<const VkDescriptorPoolSize> sizes,
                                      VkDescriptorBindingFlags more, std::span<const VkSampler> fixed = {}) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const VkDescriptorPoolSize& size : sizes)
    bindings.push_back({uint32_t(bindings.size()), size.type, size.descriptorCount, VK_SHADER_STAGE_ALL, nullptr});
  std::vector<VkDescriptorBindingFlags> flags(sizes.size(), VK_DESCRIPTOR_BINDING_PARTIALLY_BOUND_BIT | more);
  if (!fixed.empty()) {
    bindings.push_back({uint32_t(bindings.size()), VK_DESCRIPTOR_TYPE_SAMPLER, uint32_t(fixed.size()),
                        VK_SHADER_STAGE_ALL, fixed.data()});
    flags.push_back(0);
  }
  const VkDescriptorSetLayoutBindingFlagsCreateInfo flags_info{
      VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_BINDING_FLAGS_CREATE_INFO, nullptr, uint32_t(flags.size()), flags.data()};
  VkDescriptorSetLayoutCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, &flags_info};
  info.flags = more ? VK_DESCRIPTOR_SET_LAYOUT_CREATE_UPDATE_AFTER_BIND_POOL_BIT : 0;
  info.bindingCount = uint32_t(bindings.size());
  info.pBindings = bindings.data();
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  VK_CHECK(vkCreateDescriptorSetLayout(device.handle(), &info, nullptr, &layout));
  return layout;
}
}  // namespace

struct Bindless::Hidden {
  Slots sampled{least_textures};
  VkDescriptorPool pool = VK_NULL_HANDLE;
  std::vector<std::pair<VkSamplerCreateInfo, VkSampler>> samplers;
  std::array<VkSampler, SAMPLER_COUNT> graph_samplers{};
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
  for (uint32_t i = 0; i < SAMPLER_COUNT; ++i) {
    const VkSamplerCreateInfo sampler = graph_sampler(i);
    VK_CHECK(vkCreateSampler(device.handle(), &sampler, nullptr, &hidden_->graph_samplers[i]));
  }
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, counts[0]},
                                        {VK_DESCRIPTOR_TYPE_SAMPLER, counts[1]},
                                        {VK_DESCRIPTOR_TYPE_SAMPLER, SAMPLER_COUNT}};
  // Textures are added while frames that do not use them are on the device.
  set_layout_ = make_set_layout(
      device, std::span(sizes).first(2),
      VK_DESCRIPTOR_BINDING_UPDATE_AFTER_BIND_BIT | VK_DESCRIPTOR_BINDING_UPDATE_UNUSED_WHILE_PENDING_BIT,
      hidden_->graph_samplers);
  pass_set_layout_ = make_set_layout(device, pass_sizes, 0);

  VkDescriptorPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool_info.flags = VK_DESCRIPTOR_POOL_CREATE_UPDATE_AFTER_BIND_BIT;
  pool_info.maxSets = 1;
  pool_info.poolSizeCount = uint32_t(std::size(sizes));
  pool_info.pPoolSizes = sizes;
  VK_CHECK(vkCreateDescriptorPool(device.handle(), &pool_info, nullptr, &hidden_->pool));
  VkDescriptorSetAllocateInfo set_info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  set_info.descriptorPool = hidden_->pool;
  set_info.descriptorSetCount = 1;
  set_info.pSetLayouts = &set_layout_;
  VK_CHECK(vkAllocateDescriptorSets(device.handle(), &set_info, &set_));

  const VkPushConstantRange range{VK_SHADER_STAGE_ALL, 0, 128};
  VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  const VkDescriptorSetLayout layouts[] = {set_layout_, pass_set_layout_};
  info.setLayoutCount = 2;
  info.pSetLayouts = layouts;
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &range;
  VK_CHECK(vkCreatePipelineLayout(device.handle(), &info, nullptr, &layout_));
  device.set_name(VK_OBJECT_TYPE_DESCRIPTOR_SET, uint64_t(set_), "bindless");
  device.set_name(VK_OBJECT_TYPE_PIPELINE_LAYOUT, uint64_t(layout_), "bindless");
}

Bindless::~Bindless() {
  for (const auto& [info, sampler] : hidden_->samplers) vkDestroySampler(device_.handle(), sampler, nullptr);
  for (const VkSampler sampler : hidden_->graph_samplers) vkDestroySampler(device_.handle(), sampler, nullptr);
  vkDestroyPipelineLayout(device_.handle(), layout_, nullptr);
  vkDestroyDescriptorPool(device_.handle(), hidden_->pool, nullptr);
  vkDestroyDescriptorSetLayout(device_.handle(), set_layout_, nullptr);
  vkDestroyDescriptorSetLayout(device_.handle(), pass_set_layout_, nullptr);
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
