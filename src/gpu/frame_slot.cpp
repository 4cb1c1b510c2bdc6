#include "gpu/frame_slot.h"

namespace candela::gpu {

void FrameSlot::wait(size_t first, size_t last, double timeout_s) {
  const auto names_from = [&](size_t from) {
    std::string names;
    for (size_t i = from; i < last; ++i) names += (names.empty() ? "" : ", ") + pending->plan->passes[i].name;
    return names;
  };
  try {
    if (work.wait(timeout_s)) return;
  } catch (const GpuError& error) {
    throw GpuError(error.result, fmt::format("waiting for the passes {}", names_from(first)));
  }
  size_t begun = first;
  for (size_t i = first; i < last && last - first > 1; ++i)
    if (timing.reached(uint32_t(i))) begun = i;
  throw GpuError(VK_TIMEOUT,
                 fmt::format("the frame did not end within {} s; the device had come to the pass {}; not finished: {}",
                             timeout_s, pending->plan->passes[begun].name, names_from(begun)));
}

void FrameSlot::finish(double timeout_s) {
  Stopwatch watch;
  if (work.pending()) {
    try {
      wait(0, pending->plan->passes.size(), timeout_s);
    } catch (...) {
      given_up = true;
      throw;
    }
    pending->result.wait_ms += watch.lap_ms();
  }
  pending->physical.reset();
  pending->keep.clear();
}

void FrameSlot::wait_if_given_up() {
  if (!given_up) return;
  work.wait_for_end();
  end();
  given_up = false;
}

void FrameSlot::begin(FrameTicket ticket, const FramePlan& plan) {
  end();
  pending = &frame;
  frame.ticket = ticket, frame.plan = &plan;
}

void FrameSlot::end() {
  pending = nullptr;
  frame.result = {};
  frame.plan = nullptr, frame.spans_at = 0;
  frame.readbacks.clear(), frame.keep.clear();
  frame.physical.reset();
}

}  // namespace candela::gpu
