#pragma once
#include <vulkan/vulkan_core.h>

#include <vector>

#include "graph/pipeline_desc.h"

namespace candela::gpu {

// VkSpecializationInfo points into its parts, so they live together.
struct Specialization {
  explicit Specialization(const std::vector<SpecConstant>& constants) {
    for (const SpecConstant& c : constants) {
      entries.push_back({c.id, uint32_t(values.size() * 4), 4});
      values.push_back(c.value);
    }
    info = {uint32_t(entries.size()), entries.data(), values.size() * 4, values.data()};
  }
  Specialization(const Specialization&) = delete;
  Specialization& operator=(const Specialization&) = delete;
  std::vector<VkSpecializationMapEntry> entries;
  std::vector<uint32_t> values;
  VkSpecializationInfo info{};
};

}  // namespace candela::gpu
