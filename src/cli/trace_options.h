#pragma once
#include "cli/job_options.h"
#include "render/traced_frames.h"

namespace candela::cli {

// How the reference traces: of `reference`, and of films that it makes.
struct TraceOptions {
  std::string mode = "direct", sampler = "sobol", bvh = "auto", visibility = "on", ambient = "traced";
  uint64_t spp = 0;
  double seconds = 0, noise = 0, ambient_distance_m = 0;
  int bounces = 0, threads = 0;
  bool footprints = false;
  std::optional<int> fog_steps, fog_lights;
  std::vector<std::string> settings;  // of trees: bvh.NAME=VALUE
};

// All but --seconds, which leaves the picture to the machine.
void add_trace_options(CLI::App& command, TraceOptions& options);
Expected<TraceRequest> trace_request(const TraceOptions& options, const Job& job);  // checked

}  // namespace candela::cli
