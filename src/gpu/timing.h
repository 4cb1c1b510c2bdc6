#pragma once
#include <cstdint>
#include <vector>

#include "gpu/device.h"

namespace candela::gpu {

// GPU timestamps. Posts are written in order and read after the wait.
class Timing {
 public:
  explicit Timing(Device& device) : device_(device) {}
  ~Timing();
  Timing(const Timing&) = delete;
  Timing& operator=(const Timing&) = delete;
  bool available() const { return device_.timestamp_mask() != 0; }
  void reset(uint32_t posts);  // from the host; nothing that uses the pool may be running
  // Everything before the post is finished when it is taken, and nothing behind it has begun.
  void post(VkCommandBuffer commands, uint32_t index) const;
  // A mark taken when the device reaches it, without waiting for what is before: costs nothing, tells how far it came.
  void mark(VkCommandBuffer commands, uint32_t index) const;
  // A mark taken when all before it is finished, which nothing behind it waits for.
  void mark_end(VkCommandBuffer commands, uint32_t index) const;
  double at_ms(uint32_t index) const;  // by the device's clock, which wraps
  double between_ms(uint32_t first, uint32_t second) const;
  bool reached(uint32_t index) const;  // without waiting

 private:
  uint64_t ticks(uint32_t index) const;
  Device& device_;
  VkQueryPool pool_ = VK_NULL_HANDLE;
  uint32_t capacity_ = 0;
};

void full_barrier(VkCommandBuffer commands);  // everything before, then everything after

}  // namespace candela::gpu
