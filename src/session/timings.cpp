#include "session/timings.h"

#include <sys/resource.h>

#include <chrono>

#include "base/json.h"
#include "base/statistics.h"
#include "plan/frame_lamps.h"

namespace candela {
namespace {
using Json = nlohmann::ordered_json;
// Set while the program is loaded, before main.
const std::chrono::steady_clock::time_point process_begin = std::chrono::steady_clock::now();
}  // namespace

double process_clock_us() {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - process_begin).count();
}

void Timings::add(std::string stage, double milliseconds) {
  for (auto& [name, sum] : cpu_ms)
    if (name == stage) {
      sum += milliseconds;
      return;
    }
  cpu_ms.emplace_back(std::move(stage), milliseconds);
}

double Timings::total(std::string_view stage) const {
  double sum = 0;
  for (const auto& [name, milliseconds] : cpu_ms)
    if (name == stage) sum += milliseconds;
  return sum;
}

StageTimer::StageTimer(Timings& timings, std::string stage, std::string lane)
    : timings_(timings), stage_(std::move(stage)), lane_(std::move(lane)), start_us_(process_clock_us()) {}
StageTimer::~StageTimer() {
  const double length_us = process_clock_us() - start_us_;
  timings_.add(stage_, length_us * 1e-3);
  timings_.spans.push_back({stage_, lane_, start_us_, length_us});
}

uint64_t peak_resident_bytes() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return uint64_t(use.ru_maxrss) * 1024;  // Linux counts kibibytes
}

Json device_json(const gpu::DeviceInfo& device) {
  return {{"name", device.name},
          {"driver", device.driver},
          {"type", device.type},
          {"class", device.device_class},
          {"uuid", device.uuid},
          {"vulkan", fmt::format("{}.{}", device.api_major, device.api_minor)},
          {"subgroup_size", device.subgroup_size}};
}

Json memory_json(const Session& session, const FramePlan& plan) {
  const gpu::Device::MemoryUse use = session.device().memory_use();
  return {{"scene_bytes", use.scene},
          {"frame_bytes", use.frame},
          {"readback_bytes", use.readback},
          {"staging_bytes", use.staging},
          {"device_peak_bytes", use.peak},
          {"planned_transient_bytes", transient_bytes(plan)},
          {"planned_transient_bytes_unaliased", transient_bytes_unaliased(plan)},
          {"process_peak_bytes", peak_resident_bytes()}};
}

Json cpu_json(const Timings& opening, const Timings& frame) {
  // Always all stages, so that a reader need not ask which are there.
  Json cpu = Json::object();
  for (const char* stage : {"load", "decode", "upload", "animate", "light_grid", "sun_shadows", "local_shadows",
                            "trees", "plan", "compile", "allocate", "record", "wait", "read_back", "encode"})
    cpu[stage] = 0.0;
  for (const Timings* timings : {&opening, &frame})
    for (const auto& [stage, milliseconds] : timings->cpu_ms) cpu[stage] = cpu.value(stage, 0.0) + milliseconds;
  return cpu;
}

Json uploaded_json(const Timings& opening, const Timings& frames) {
  return {{"opening", opening.uploaded_bytes}, {"frames", frames.uploaded_bytes}};
}

Json timings_json(const FrameResult& frame, const Job& job, const Session& session) {
  Json j;
  j["version"] = CANDELA_VERSION;
  j["device"] = device_json(session.device().info());
  j["plan_hash"] = frame.plan_hash.hex();
  j["size"] = {frame.width_px, frame.height_px};
  j["time_s"] = frame.time_s;
  if (!frame.timings.gpu_ms.empty()) {
    j["gpu_frame_ms"] = frame.timings.frame_gpu_ms;
    Json& passes = j["gpu_ms"] = Json::object();
    for (const gpu::PassTime& pass : frame.timings.gpu_ms)
      passes[pass.name] = passes.value(pass.name, 0.0) + pass.gpu_ms;
  }
  if (const auto& overlap = frame.timings.overlap)
    j["overlap"] = {{"queues", overlap->queues},
                    {"batches", overlap->batches},
                    {"runs", overlap->runs},
                    {"all_queues_ms", overlap->all_queues_ms},
                    {"one_queue_ms", overlap->one_queue_ms}};
  j["cpu_ms"] = cpu_json(session.opening(), frame.timings);
  j["process_ms"] = process_clock_us() * 1e-3;
  j["memory"] = memory_json(session, *frame.plan);
  j["uploaded_bytes"] = uploaded_json(session.opening(), frame.timings);
  j["heap_allocations"] = frame.timings.heap_allocations;
  j["left_out"] = Json::array();
  for (const LeftOut& left : frame.plan->left_out)
    j["left_out"].push_back({{"pass", left.pass}, {"reason", left.reason}});
  j["job"] = own_json(job_json(job));
  return j;
}

std::string trace_json(std::span<const Timings::Span> spans) {
  std::vector<std::string> lanes;
  Json events = Json::array();
  for (const Timings::Span& span : spans) {
    auto lane = std::find(lanes.begin(), lanes.end(), span.lane);
    if (lane == lanes.end()) {
      lanes.push_back(span.lane);
      lane = lanes.end() - 1;
      events.push_back(
          {{"name", "thread_name"}, {"ph", "M"}, {"pid", 1}, {"tid", lanes.size()}, {"args", {{"name", span.lane}}}});
    }
    events.push_back({{"name", span.name},
                      {"cat", span.lane},
                      {"ph", "X"},
                      {"ts", span.start_us},
                      {"dur", span.length_us},
                      {"pid", 1},
                      {"tid", lane - lanes.begin() + 1}});
  }
  return Json({{"traceEvents", events}, {"displayTimeUnit", "ms"}}).dump(1, ' ', false, Json::error_handler_t::replace);
}

Timings::Overlap measure_overlap(gpu::FrameRunner& runner, const gpu::Device& device, const CompiledGraph& graph,
                                 const gpu::Imports& imports, const gpu::ByResource<gpu::KeptImage>& images) {
  constexpr int runs = 15;
  std::vector<double> all, one;
  for (int i = 0; i <= runs; ++i)  // the first of each warms up
    for (const bool one_queue : {false, true}) {
      const double ms = runner.run(graph, imports, {.whole = true, .one_queue = one_queue, .images = images}).whole_ms;
      if (i > 0) (one_queue ? one : all).push_back(ms);
    }
  return {device.has_second_queue() ? 2 : 1, std::max(1, int(graph.plan.batches.size())), runs, median(all),
          median(one)};
}

void count_lamp_maps(const FrameLamps& lamps, Timings& timings) {
  timings.lamp_maps = timings.lamp_maps_drawn = lamps.maps;
  if (!lamps.image || !lamps.image->apart) return;
  const std::vector<uint32_t>& drawn = lamps.image->drawn;
  const auto over = std::ranges::lower_bound(drawn, lamps.image->first_over());
  timings.lamp_maps_drawn = uint64_t(over - drawn.begin());
  timings.lamp_maps_over = uint64_t(drawn.end() - over);
}

}  // namespace candela
