#include "gpu/queue_work.h"

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
  for (Pool& pool : pools_) pool.used = 0;
}

VkCommandBuffer QueueWork::begin() {
  restart();
  parts_.push_back({Queue::main, take(Queue::main), {}});
  return parts_.back().commands;
}

VkCommandBuffer QueueWork::add(Queue queue, std::vector<Point> waits, Point& reached) {
  if (!device_.has_second_queue()) queue = Queue::main;
  reached = {queue, timelines_.next(queue)};
  parts_.push_back({queue, take(queue), std::move(waits), reached.value});
  return parts_.back().commands;
}

// The waits of one queue may come before the signals of the other: timelines allow it.
void QueueWork::submit() {
  CHECK(!parts_.empty() && parts_.back().queue == Queue::main);
  for (const Part& part : parts_) VK_CHECK(vkEndCommandBuffer(part.commands));
  if (device_.has_second_queue()) submit_to(device_.compute_queue(), VK_NULL_HANDLE);
  submit_to(device_.queue(), fence_);
  pending_ = true;
  restart();
}

void QueueWork::submit_to(VkQueue queue, VkFence fence) {
  const auto semaphore_info = [&](const Point& point) {
    VkSemaphoreSubmitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
    info.semaphore = timelines_.semaphore(point.queue);
    info.value = point.value;
    info.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    return info;
  };
  struct Pointed {
    VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
    std::vector<VkSemaphoreSubmitInfo> waits;
    VkSemaphoreSubmitInfo signal;
  };
  std::vector<Pointed> pointed;
  for (const Part& part : parts_) {
    if (queue_of(part.queue) != queue) continue;
    Pointed& p = pointed.emplace_back();
    p.commands.commandBuffer = part.commands;
    for (const Point& wait : part.waits) p.waits.push_back(semaphore_info(wait));
    p.signal = semaphore_info({part.queue, part.signal});
  }
  std::vector<VkSubmitInfo2> infos;
  for (const Pointed& p : pointed) {
    VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
    info.waitSemaphoreInfoCount = uint32_t(p.waits.size());
    info.pWaitSemaphoreInfos = p.waits.data();
    info.commandBufferInfoCount = 1;
    info.pCommandBufferInfos = &p.commands;
    info.signalSemaphoreInfoCount = p.signal.value > 0 ? 1 : 0;
    info.pSignalSemaphoreInfos = &p.signal;
    infos.push_back(info);
  }
  if (!infos.empty()) VK_CHECK(vkQueueSubmit2(queue, uint32_t(infos.size()), infos.data(), fence));
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
