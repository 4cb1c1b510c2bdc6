#include "gpu/frame_slot.h"

namespace candela::gpu {

void FrameSlot::wait(size_t first, size_t last, double timeout_s) {
  const auto names_from = [&](size_t from) {
    std::string names;
    for (size_t i = from; i < last; ++i) names += (names.empty() ? "" : ", ") + pending->passes[i];
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
                             timeout_s, pending->passes[begun], names_from(begun)));
}

void FrameSlot::finish(double timeout_s) {
  Stopwatch watch;
  if (work.pending()) {
    try {
      wait(0, pending->passes.size(), timeout_s);
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
  pending.reset();
  given_up = false;
}

}  // namespace candela::gpu
