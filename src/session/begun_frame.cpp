#include "session/begun_frame.h"

#include <cstring>

namespace candela {

void take_run(gpu::FrameRun run, double& device_clock_us, BegunFrame& begun) {
  FrameResult& result = begun.result;
  Timings& t = result.timings;
  t.add("record", run.record_ms);
  t.add("wait", run.submit_ms + run.wait_ms);
  double gpu_at = begun.submit_us + run.record_ms * 1000;
  for (const gpu::PassTime& pass : run.passes) {
    t.spans.push_back({pass.name, "gpu", gpu_at, pass.gpu_ms * 1000});
    gpu_at += pass.gpu_ms * 1000;
  }
  if (run.on_device) {
    const double began_us = run.on_device->began_ms * 1000;
    device_clock_us = std::max(device_clock_us, begun.submit_us + run.record_ms * 1000 - began_us);
    t.spans.push_back({"frame", "gpu", device_clock_us + began_us, run.on_device->length_ms * 1000});
  }
  t.gpu_ms = std::move(run.passes);
  t.frame_gpu_ms = run.frame_gpu_ms;
  result.readbacks = std::move(run.readbacks);
  result.hashes = std::move(run.hashes);
  if (const auto found = result.readbacks.find(begun.made->counts); found != result.readbacks.end()) {
    const std::span<const std::byte> bytes = found->second->bytes();
    result.counts.resize(bytes.size() / sizeof(shared::PackCounts));
    std::memcpy(result.counts.data(), bytes.data(), result.counts.size() * sizeof(shared::PackCounts));
  }
  for (const FrameReport& report : begun.made->reports) {
    const auto found = result.readbacks.find(report.resource);
    if (found == result.readbacks.end()) continue;
    const std::span<const std::byte> bytes = found->second->bytes();
    for (std::string& warning : report.warnings(bytes)) result.warnings.push_back(std::move(warning));
    if (report.enlarged && report.refusal && begun.enlarged.empty() && !report.refusal(bytes).empty())
      begun.enlarged = report.enlarged(bytes);
    if (report.refusal && begun.refusal.empty()) begun.refusal = report.refusal(bytes);
    if (!report.notes) continue;
    for (std::string& note : report.notes(bytes)) result.notes.push_back(std::move(note));
  }
}

void add_stages(const StageClock& clock, double start_us, Timings& timings) {
  for (const auto& [stage, ms] : clock.stages()) {
    timings.add(stage, ms);
    timings.spans.push_back({stage, "cpu", start_us, ms * 1000});
    start_us += ms * 1000;
  }
}

void add_times(const SubmitTimes& times, Timings& timings) {
  const double upload_us = times.allocate_us - times.upload_us;
  timings.add("decode", times.decode_ms);
  timings.add("upload", upload_us / 1000 - times.decode_ms);
  timings.spans.push_back({"decode and upload", "cpu", times.upload_us, upload_us});
  const double allocate_us = times.allocated_us - times.allocate_us;
  timings.add("allocate", allocate_us / 1000);
  timings.spans.push_back({"allocate", "cpu", times.allocate_us, allocate_us});
  timings.add("compile", times.compiling.total("compile"));
  for (const Timings* of : {&times.compiling, &times.measuring})
    timings.spans.insert(timings.spans.end(), of->spans.begin(), of->spans.end());
  for (const auto& [stage, ms] : times.measuring.cpu_ms) timings.add(stage, ms);
  timings.overlap = times.measuring.overlap;
  timings.spans.push_back({"record and submit", "cpu", times.submit_us, times.end_us - times.submit_us});
}

}  // namespace candela
