#include "gpu/pipeline_store.h"

#include <algorithm>
#include <span>

#include "base/check.h"
#include "gpu/bindless.h"
#include "gpu/pipelines.h"

namespace candela::gpu {

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
VkDescriptorSetLayout make_set_layout(VkDevice device, std::span<const VkDescriptorPoolSize> sizes,
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
  VK_CHECK(vkCreateDescriptorSetLayout(device, &info, nullptr, &layout));
  return layout;
}
}  // namespace

PipelineStore::~PipelineStore() {
  by_key_.clear();
  used_.clear();
  for (const auto& [sizes, layout] : layouts_) {
    vkDestroyPipelineLayout(device_, layout.handle, nullptr);
    vkDestroyDescriptorSetLayout(device_, layout.set, nullptr);
    vkDestroyDescriptorSetLayout(device_, layout.pass_set, nullptr);
    for (const VkSampler sampler : layout.graph_samplers) vkDestroySampler(device_, sampler, nullptr);
  }
}

const PipelineLayout& PipelineStore::layout(uint32_t textures, uint32_t samplers) {
  std::lock_guard lock(mutex_);
  PipelineLayout& made = layouts_[{textures, samplers}];
  if (made.handle) return made;
  made.textures = textures, made.samplers = samplers;
  // What a call that failed half-way left is taken up.
  for (uint32_t i = 0; i < SAMPLER_COUNT; ++i) {
    if (made.graph_samplers[i]) continue;
    const VkSamplerCreateInfo sampler = graph_sampler(i);
    VK_CHECK(vkCreateSampler(device_, &sampler, nullptr, &made.graph_samplers[i]));
  }
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, textures},
                                        {VK_DESCRIPTOR_TYPE_SAMPLER, samplers}};
  // Textures are added while frames that do not use them are on the device.
  constexpr VkDescriptorBindingFlags added_later =
      VK_DESCRIPTOR_BINDING_UPDATE_AFTER_BIND_BIT | VK_DESCRIPTOR_BINDING_UPDATE_UNUSED_WHILE_PENDING_BIT;
  if (!made.set) made.set = make_set_layout(device_, sizes, added_later, made.graph_samplers);
  if (!made.pass_set) made.pass_set = make_set_layout(device_, Bindless::pass_sizes, 0);
  const VkPushConstantRange range{VK_SHADER_STAGE_ALL, 0, 128};
  VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  const VkDescriptorSetLayout layouts[] = {made.set, made.pass_set};
  info.setLayoutCount = 2;
  info.pSetLayouts = layouts;
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &range;
  VK_CHECK(vkCreatePipelineLayout(device_, &info, nullptr, &made.handle));
  return made;
}

const PipelineLayout& PipelineStore::layout_of(VkPipelineLayout handle) {
  std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(layouts_, [&](const auto& one) { return one.second.handle == handle; });
  CHECK(found != layouts_.end());
  return found->second;
}

std::shared_ptr<const Pipeline> PipelineStore::find(const std::string& key) {
  std::lock_guard lock(mutex_);
  const auto found = by_key_.find(key);
  if (found == by_key_.end()) return nullptr;
  used_.splice(used_.begin(), used_, found->second);
  return found->second->pipeline;
}

std::shared_ptr<const Pipeline> PipelineStore::insert(const std::string& key, Pipeline made) {
  const auto destroy = [device = device_](const Pipeline* pipeline) {
    vkDestroyPipeline(device, pipeline->handle, nullptr);
    delete pipeline;
  };
  std::shared_ptr<const Pipeline> pipeline(new Pipeline(std::move(made)), destroy);
  std::lock_guard lock(mutex_);
  if (const auto found = by_key_.find(key); found != by_key_.end()) return found->second->pipeline;
  used_.push_front({key, pipeline});
  by_key_[key] = used_.begin();
  size_t idle = 0;
  for (auto at = used_.begin(); at != used_.end();) {
    const bool is_idle = at->pipeline.use_count() == 1;
    if (is_idle && ++idle > most_idle) {
      by_key_.erase(at->key);
      at = used_.erase(at);
    } else {
      ++at;
    }
  }
  return pipeline;
}

}  // namespace candela::gpu
