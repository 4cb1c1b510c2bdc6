#pragma once
#include <vector>

#include "gpu/device.h"

namespace candela::gpu {

// Command buffers for the one queue, and the wait for them. One piece of work at a time.
class QueueWork {
 public:
  explicit QueueWork(Device& device);
  ~QueueWork();
  QueueWork(const QueueWork&) = delete;
  QueueWork& operator=(const QueueWork&) = delete;
  VkCommandBuffer begin();  // waits first for work that an earlier wait gave up on
  void submit();
  bool wait(double timeout_s);  // false: not finished in time; other failures throw

 private:
  Device& device_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  bool pending_ = false;
};

}  // namespace candela::gpu
