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
  std::vector<std::string> passes;
  std::vector<std::shared_ptr<ReadbackPool::Pooled>> readbacks;  // those of the result
  std::shared_ptr<Physical> physical;
  std::vector<std::shared_ptr<const void>> keep;
};

// What one frame in flight has for itself. Its number is that of its descriptor sets in Physical.
struct FrameSlot {
  size_t index;
  Timing timing;
  std::optional<PendingFrame> pending;  // from submit to collect
  bool given_up = false;                // a wait failed; whatever it holds stays until the device is done
  QueueWork work;                       // last: its end waits for the device, before what the device uses goes

  FrameSlot(Device& device, QueueTimelines& timelines, size_t i) : index(i), timing(device), work(device, timelines) {}
  // Waits for the passes [first, last) of one submission. Their marks or posts tell how far the device came.
  void wait(size_t first, size_t last, double timeout_s);
  // Waits for the whole frame, unless that is done, and lets go of what the device no longer needs.
  void finish(double timeout_s);
  void wait_if_given_up();
};

}  // namespace candela::gpu
