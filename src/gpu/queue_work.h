#pragma once
#include <array>
#include <span>
#include <vector>

#include "gpu/device.h"
#include "graph/plan.h"

namespace candela::gpu {

// A timeline semaphore for each queue, which counts what was submitted to it. All work of a runner shares them.
class QueueTimelines {
 public:
  explicit QueueTimelines(Device& device);
  ~QueueTimelines();
  QueueTimelines(const QueueTimelines&) = delete;
  QueueTimelines& operator=(const QueueTimelines&) = delete;
  VkSemaphore semaphore(Queue queue) const { return semaphores_[size_t(queue)]; }
  uint64_t next(Queue queue) { return ++last_[size_t(queue)]; }

 private:
  Device& device_;
  std::array<VkSemaphore, 2> semaphores_{};
  std::array<uint64_t, 2> last_{};
};

// Command buffers for the queues, submitted together, and the wait for them. One piece of work at a time.
class QueueWork {
 public:
  QueueWork(Device& device, QueueTimelines& timelines);
  ~QueueWork();
  QueueWork(const QueueWork&) = delete;
  QueueWork& operator=(const QueueWork&) = delete;

  // A place on a queue's timeline: reached when the command buffer and all before it on its queue have ended.
  struct Point {
    Queue queue = Queue::main;
    uint64_t value = 0;
  };
  // The only command buffer of the work. Nothing may be pending.
  VkCommandBuffer begin();
  // Several: restart, then each behind the others of its queue; it waits for the points, and `reached` is its own. The
  // last one is of the main queue and waits for the end of the others.
  void restart();
  VkCommandBuffer add(Queue queue, std::span<const Point> waits, Point& reached);
  void submit();
  bool wait(double timeout_s);               // false: not finished in time; other failures throw
  void wait_for_end();                       // of work that an earlier wait gave up on
  bool pending() const { return pending_; }  // submitted, and no wait has seen its end

 private:
  struct Part {
    Queue queue;
    VkCommandBuffer commands;
    size_t first_wait = 0, wait_count = 0;  // in waits_
    uint64_t signal = 0;                    // 0: none
  };
  VkCommandBuffer take(Queue queue);
  void submit_parts(std::span<const Part> parts, VkFence fence);
  VkQueue queue_of(Queue queue) const { return queue == Queue::main ? device_.queue() : device_.compute_queue(); }

  Device& device_;
  QueueTimelines& timelines_;
  struct Pool {
    VkCommandPool pool = VK_NULL_HANDLE;  // made when first used
    std::vector<VkCommandBuffer> buffers;
    size_t used = 0;
  };
  std::array<Pool, 2> pools_;
  std::vector<Part> parts_;  // begun and not yet submitted
  std::vector<Point> waits_;
  struct Pointed {  // of a part, in Vulkan's terms
    VkCommandBufferSubmitInfo commands{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
    VkSemaphoreSubmitInfo signal;
  };
  std::vector<VkSemaphoreSubmitInfo> wait_infos_;
  std::vector<Pointed> pointed_;
  std::vector<VkSubmitInfo2> infos_;
  VkFence fence_ = VK_NULL_HANDLE;
  bool pending_ = false;
};

}  // namespace candela::gpu
