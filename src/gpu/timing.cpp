#include "gpu/timing.h"

#include <array>

#include "base/check.h"

namespace candela::gpu {

Timing::~Timing() { vkDestroyQueryPool(device_.handle(), pool_, nullptr); }

void Timing::reset(uint32_t posts) {
  if (!available()) return;
  if (posts > capacity_) {
    vkDestroyQueryPool(device_.handle(), pool_, nullptr);
    pool_ = VK_NULL_HANDLE;
    VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = posts;
    VK_CHECK(vkCreateQueryPool(device_.handle(), &info, nullptr, &pool_));
    device_.set_name(VK_OBJECT_TYPE_QUERY_POOL, uint64_t(pool_), "pass times");
    capacity_ = posts;
  }
  vkResetQueryPool(device_.handle(), pool_, 0, capacity_);
}

void Timing::post(VkCommandBuffer commands, uint32_t index) const {
  CHECK(index < capacity_);
  full_barrier(commands);
  vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, index);
  full_barrier(commands);
}

void Timing::mark(VkCommandBuffer commands, uint32_t index) const {
  CHECK(index < capacity_);
  vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT, pool_, index);
}

void Timing::mark_end(VkCommandBuffer commands, uint32_t index) const {
  CHECK(index < capacity_);
  vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, index);
}

uint64_t Timing::ticks(uint32_t index) const {
  uint64_t value = 0;
  VK_CHECK(vkGetQueryPoolResults(device_.handle(), pool_, index, 1, sizeof value, &value, sizeof value,
                                 VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT));
  return value & device_.timestamp_mask();
}

double Timing::at_ms(uint32_t index) const { return double(ticks(index)) * device_.timestamp_period_ns() * 1e-6; }

double Timing::between_ms(uint32_t first, uint32_t second) const {
  // The difference within the valid bits is right also where the counter wrapped in between.
  const uint64_t elapsed = (ticks(second) - ticks(first)) & device_.timestamp_mask();
  return double(elapsed) * device_.timestamp_period_ns() * 1e-6;
}

bool Timing::reached(uint32_t index) const {
  if (!pool_ || index >= capacity_) return false;
  std::array<uint64_t, 2> value{};  // result, availability
  const VkResult result =
      vkGetQueryPoolResults(device_.handle(), pool_, index, 1, sizeof value, value.data(), sizeof value,
                            VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WITH_AVAILABILITY_BIT);
  return result == VK_SUCCESS && value[1] != 0;
}

void full_barrier(VkCommandBuffer commands) {
  VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  memory.srcStageMask = memory.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  memory.srcAccessMask = memory.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &memory;
  vkCmdPipelineBarrier2(commands, &info);
}

}  // namespace candela::gpu
