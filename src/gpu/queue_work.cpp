#include "gpu/queue_work.h"

#include "base/check.h"

namespace candela::gpu {

QueueWork::QueueWork(Device& device) : device_(device) {
  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.queueFamilyIndex = device.queue_family();
  VK_CHECK(vkCreateCommandPool(device.handle(), &pool, nullptr, &pool_));
  VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  info.commandPool = pool_;
  info.commandBufferCount = 1;
  VK_CHECK(vkAllocateCommandBuffers(device.handle(), &info, &commands_));
  device.set_name(VK_OBJECT_TYPE_COMMAND_BUFFER, uint64_t(commands_), "frame");
  VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  VK_CHECK(vkCreateFence(device.handle(), &fence, nullptr, &fence_));
}

QueueWork::~QueueWork() {
  vkDeviceWaitIdle(device_.handle());
  vkDestroyFence(device_.handle(), fence_, nullptr);
  vkDestroyCommandPool(device_.handle(), pool_, nullptr);
}

VkCommandBuffer QueueWork::begin() {
  CHECK(!pending_);
  VK_CHECK(vkResetCommandPool(device_.handle(), pool_, 0));
  VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  VK_CHECK(vkBeginCommandBuffer(commands_, &info));
  return commands_;
}

void QueueWork::submit() {
  VK_CHECK(vkEndCommandBuffer(commands_));
  VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, commands_};
  VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &buffer;
  VK_CHECK(vkQueueSubmit2(device_.queue(), 1, &info, fence_));
  pending_ = true;
}

void QueueWork::wait_for_end() {
  constexpr double long_s = 1e9;
  if (pending_) wait(long_s);
}

bool QueueWork::wait(double timeout_s) {
  constexpr double longest_s = 1e9;
  const auto timeout_ns = uint64_t(std::clamp(timeout_s, 0.0, longest_s) * 1e9);
  const VkResult result = vkWaitForFences(device_.handle(), 1, &fence_, VK_TRUE, timeout_ns);
  if (result == VK_TIMEOUT) return false;
  VK_CHECK(result);
  VK_CHECK(vkResetFences(device_.handle(), 1, &fence_));
  pending_ = false;
  return true;
}

}  // namespace candela::gpu
