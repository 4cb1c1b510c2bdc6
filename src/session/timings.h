#pragma once
#include <nlohmann/json_fwd.hpp>
#include <span>

#include "session/session.h"

namespace candela {

struct FrameLamps;

// The file of --timings: GPU milliseconds by pass (absent when they were not measured), CPU milliseconds by stage (the
// session's opening and the frame's), device and driver, memory by lifetime and at its peak, plan hash, job.
nlohmann::ordered_json timings_json(const FrameResult& frame, const Job& job, const Session& session);
nlohmann::ordered_json device_json(const gpu::DeviceInfo& device);
nlohmann::ordered_json memory_json(const Session& session, const FramePlan& plan);
nlohmann::ordered_json cpu_json(const Timings& opening, const Timings& frame);
nlohmann::ordered_json uploaded_json(const Timings& opening, const Timings& frames);

// Chrome's trace event format, which Perfetto opens: one row per lane.
std::string trace_json(std::span<const Timings::Span> spans);

// The highest resident memory of this process so far.
uint64_t peak_resident_bytes();

// Measures a stage: on destruction adds its milliseconds and its span.
class StageTimer {
 public:
  StageTimer(Timings& timings, std::string stage, std::string lane = "cpu");
  ~StageTimer();
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  Timings& timings_;
  std::string stage_, lane_;
  double start_us_;
};

// The frame as a whole with its passes on both queues and on one: medians of interleaved runs.
Timings::Overlap measure_overlap(gpu::FrameRunner& runner, const gpu::Device& device, const CompiledGraph& graph,
                                 const gpu::Imports& imports, const gpu::ByResource<gpu::KeptImage>& images);

// Counts the lamps' maps of a frame.
void count_lamp_maps(const FrameLamps& lamps, Timings& timings);

}  // namespace candela
