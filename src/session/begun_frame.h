#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "plan/planned_graph.h"
#include "session/session.h"

namespace candela {

// A frame that the device was given, and what its result needs beside what the device leaves.
struct BegunFrame {
  FrameResult result;
  std::shared_ptr<const PlannedGraph> made;  // whose reports are read
  std::string refusal;                       // why the device's picture is not the frame's
  std::vector<KnobSetting> enlarged;         // with which it would be
  bool hash_outputs = false;
  double submit_us = 0;                // when recording began
  std::vector<FrameTicket> subframes;  // begun before it, whose mean it takes
  bool collected = false;
  std::optional<Error> error;  // found when it was collected
};
// What the device left. device_clock_us: 0 of its clock by the process's, as far as the frames so far tell: none began
// before it was handed over.
void take_run(gpu::FrameRun run, double& device_clock_us, BegunFrame& begun);

// When the stages between planning and submission began, microseconds of the process's clock.
struct SubmitTimes {
  double upload_us = 0, allocate_us = 0, allocated_us = 0, submit_us = 0, end_us = 0;
  double decode_ms = 0;
  Timings compiling;         // beside them
  Timings measuring;         // runs before the frame's own
  uint64_t allocations = 0;  // heap_allocations() at the end
};
void add_times(const SubmitTimes& times, Timings& timings);
// The stages of planning, one after another from start_us on.
void add_stages(const StageClock& clock, double start_us, Timings& timings);

}  // namespace candela
