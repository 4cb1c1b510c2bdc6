#include "gpu/queue_work.h"

#include <algorithm>

#include "base/check.h"

namespace candela::gpu {

QueueTimelines::QueueTimelines(Device& device) : device_(device) {
  VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
  type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
  const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &type};
  for (VkSemaphore& semaphore : semaphores_) VK_CHECK(vkCreateSemaphore(device.handle(), &info, nullptr, &semaphore));
}

QueueTimelines::~QueueTimelines() {
  for (const VkSemaphore semaphore : semaphores_) vkDestroySemaphore(device_.handle(), semaphore, nullptr);
}

QueueWork::QueueWork(Device& device, QueueTimelines& timelines) : device_(device), timelines_(timelines) {
  VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  VK_CHECK(vkCreateFence(device.handle(), &fence, nullptr, &fence_));
}

QueueWork::~QueueWork() {
  vkDeviceWaitIdle(device_.handle());
  vkDestroyFence(device_.handle(), fence_, nullptr);
  for (const Pool& pool : pools_) vkDestroyCommandPool(device_.handle(), pool.pool, nullptr);
}

VkCommandBuffer QueueWork::take(Queue queue) {
  CHECK(!pending_);
  Pool& pool = pools_[size_t(queue)];
  if (!pool.pool) {
    VkCommandPoolCreateInfo info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    info.queueFamilyIndex = queue == Queue::main ? device_.queue_family() : device_.compute_family();
    VK_CHECK(vkCreateCommandPool(device_.handle(), &info, nullptr, &pool.pool));
  }
  if (pool.used == 0) VK_CHECK(vkResetCommandPool(device_.handle(), pool.pool, 0));
  if (pool.used == pool.buffers.size()) {
    VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    info.commandPool = pool.pool;
    info.commandBufferCount = 1;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    VK_CHECK(vkAllocateCommandBuffers(device_.handle(), &info, &commands));
    device_.set_name(VK_OBJECT_TYPE_COMMAND_BUFFER, uint64_t(commands), "frame");
    pool.buffers.push_back(commands);
  }
  const VkCommandBuffer commands = pool.buffers[pool.used++];
  VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  VK_CHECK(vkBeginCommandBuffer(commands, &info));
  return commands;
}

void QueueWork::restart() {
  parts_.clear();
  waits_.clear();
  for (Pool& pool : pools_) pool.used = 0;
}

VkCommandBuffer QueueWork::begin() {
  restart();
  parts_.push_back({Queue::main, take(Queue::main)});
  return parts_.back().commands;
}

VkCommandBuffer QueueWork::add(Queue queue, std::span<const Point> waits, Point& reached) {
  if (!device_.has_second_queue()) queue = Queue::main;
  reached = {queue, timelines_.next(queue)};
  parts_.push_back({queue, take(queue), waits_.size(), waits.size(), reached.value});
  waits_.insert(waits_.end(), waits.begin(), waits.end());
  return parts_.back().commands;
}

// In the order in which the parts were added, neighbours of one queue together. Timelines would allow one call a queue,
// waits before their signals; the validation layer (1.3.239) then follows layouts in the order of the calls, and
// reports images of the main queue as undefined.
void QueueWork::submit() {
  CHECK(!parts_.empty() && parts_.back().queue == Queue::main);
  for (const Part& part : parts_) VK_CHECK(vkEndCommandBuffer(part.commands));
  for (auto first = parts_.begin(); first != parts_.end();) {
    const auto last =
        std::find_if(first, parts_.end(), [&](const Part& p) { return queue_of(p.queue) != queue_of(first->queue); });
    submit_parts({first, last}, last == parts_.end() ? fence_ : VK_NULL_HANDLE);
    first = last;
  }
  pending_ = true;
  restart();
}

void QueueWork::submit_parts(std::span<const Part> parts, VkFence fence) {
  const auto semaphore_info = [&](const Point& point) {
    VkSemaphoreSubmitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
    info.semaphore = timelines_.semaphore(point.queue);
    info.value = point.value;
    info.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    return info;
  };
  wait_infos_.clear();
  for (const Part& part : parts)
    for (size_t w = 0; w < part.wait_count; ++w) wait_infos_.push_back(semaphore_info(waits_[part.first_wait + w]));
  pointed_.assign(parts.size(), {});
  infos_.assign(parts.size(), {VK_STRUCTURE_TYPE_SUBMIT_INFO_2});
  size_t first_wait = 0;
  for (size_t i = 0; i < parts.size(); ++i) {
    Pointed& p = pointed_[i];
    p.commands.commandBuffer = parts[i].commands;
    p.signal = semaphore_info({parts[i].queue, parts[i].signal});
    infos_[i].waitSemaphoreInfoCount = uint32_t(parts[i].wait_count);
    infos_[i].pWaitSemaphoreInfos = wait_infos_.data() + first_wait;
    infos_[i].commandBufferInfoCount = 1;
    infos_[i].pCommandBufferInfos = &p.commands;
    infos_[i].signalSemaphoreInfoCount = p.signal.value > 0 ? 1 : 0;
    infos_[i].pSignalSemaphoreInfos = &p.signal;
    first_wait += parts[i].wait_count;
  }
  VK_CHECK(vkQueueSubmit2(queue_of(parts.front().queue), uint32_t(infos_.size()), infos_.data(), fence));
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

void QueueWork::wait_for_end() {
  constexpr double long_s = 1e9;
  if (pending_) wait(long_s);
}

}  // namespace candela::gpu
