#pragma once
#include <vulkan/vulkan_core.h>

#include <array>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "shared/samplers.h"

namespace candela::gpu {

struct Pipeline;

// The one layout of all pipelines, for sets of up to `textures` sampled images: see gpu/bindless.h. Pipelines made with
// it serve every set that is of it.
struct PipelineLayout {
  uint32_t textures = 0, samplers = 0;
  VkPipelineLayout handle = VK_NULL_HANDLE;
  VkDescriptorSetLayout set = VK_NULL_HANDLE, pass_set = VK_NULL_HANDLE;
  std::array<VkSampler, SAMPLER_COUNT> graph_samplers{};
};

// What all that is opened on one VkDevice in a process shares, and keeps until the device is closed: layouts, and
// pipelines by all that they are made of. Drivers take tens of milliseconds for a pipeline, also where their own caches
// know it, and a process that opens one scene after another wants the same ones. Safe for use by several threads.
class PipelineStore {
 public:
  explicit PipelineStore(VkDevice device) : device_(device) {}
  ~PipelineStore();
  PipelineStore(const PipelineStore&) = delete;
  PipelineStore& operator=(const PipelineStore&) = delete;

  // For so many textures and samplers; made at the first call. Throws GpuError.
  const PipelineLayout& layout(uint32_t textures, uint32_t samplers);
  const PipelineLayout& layout_of(VkPipelineLayout handle);  // one of those

  // key: shaders by content, constants, state and layout. Null: there is none.
  std::shared_ptr<const Pipeline> find(const std::string& key);
  // Takes it over, destroys it when it is not kept any more, and gives what is kept under the key: another thread may
  // have been quicker. Of those that nobody uses the ones used last stay, `most_idle` at most.
  std::shared_ptr<const Pipeline> insert(const std::string& key, Pipeline made);
  static constexpr size_t most_idle = 64;

 private:
  struct Entry {
    std::string key;
    std::shared_ptr<const Pipeline> pipeline;
  };
  VkDevice device_;
  std::mutex mutex_;                                                 // guards what follows
  std::map<std::pair<uint32_t, uint32_t>, PipelineLayout> layouts_;  // nodes stay where they are
  std::list<Entry> used_;                                            // the last one first
  std::map<std::string, std::list<Entry>::iterator> by_key_;
};

}  // namespace candela::gpu
