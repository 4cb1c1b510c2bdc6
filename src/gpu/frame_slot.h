#pragma once
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gpu/frame_runner.h"
#include "gpu/physical.h"
#include "gpu/queue_work.h"
#include "gpu/timing.h"

namespace candela::gpu {

class Stopwatch {
 public:
  double lap_ms() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - start_).count();
    start_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// A submitted frame, and what must live until the device is done with it.
struct PendingFrame {
  FrameTicket ticket = 0;
  FrameRun result;
  const FramePlan* plan = nullptr;
  uint32_t spans_at = 0;  // number of its first mark, where it is to say when it began and ended
  std::vector<std::pair<int, std::shared_ptr<ReadbackPool::Pooled>>> readbacks;  // by resource
  std::shared_ptr<Physical> physical;
  std::vector<std::shared_ptr<const void>> keep;
};

// What one frame in flight has for itself. Its number is that of its descriptor sets in Physical.
struct FrameSlot {
  size_t index;
  Timing timing;
  PendingFrame frame;               // its memory serves all frames of the slot
  PendingFrame* pending = nullptr;  // from submit to collect: `frame`
  bool given_up = false;            // a wait failed; whatever it holds stays until the device is done
  // Of the frame at hand, for recording; their memory serves all frames of the slot.
  std::vector<const Buffer*> buffers;
  std::vector<const KeptImage*> kept;
  std::vector<VkImageMemoryBarrier2> barriers;
  std::vector<QueueWork::Point> reached, waits;
  QueueWork work;  // behind what the device uses: its end waits for the device

  FrameSlot(Device& device, QueueTimelines& timelines, size_t i) : index(i), timing(device), work(device, timelines) {}
  // Waits for the passes [first, last) of one submission. Their marks or posts tell how far the device came.
  void wait(size_t first, size_t last, double timeout_s);
  // Waits for the whole frame, unless that is done, and lets go of what the device no longer needs.
  void finish(double timeout_s);
  void wait_if_given_up();
  void begin(FrameTicket ticket, const FramePlan& plan);
  void end();  // the frame is no longer pending
};

}  // namespace candela::gpu
