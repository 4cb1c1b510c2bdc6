#pragma once
#include <vector>

#include "gpu/device.h"

namespace candela::gpu {

// A command buffer for the one queue, and the wait for it. One piece of work at a time.
class QueueWork {
 public:
  explicit QueueWork(Device& device);
  ~QueueWork();
  QueueWork(const QueueWork&) = delete;
  QueueWork& operator=(const QueueWork&) = delete;
  VkCommandBuffer begin();  // nothing may be pending
  void submit();
  bool wait(double timeout_s);               // false: not finished in time; other failures throw
  void wait_for_end();                       // of work that an earlier wait gave up on
  bool pending() const { return pending_; }  // submitted, and no wait has seen its end

 private:
  Device& device_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  bool pending_ = false;
};

}  // namespace candela::gpu
