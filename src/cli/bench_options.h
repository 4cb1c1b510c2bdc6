#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/error_sweep.h"
#include "bench/exactness.h"
#include "bench/stillness.h"
#include "bench/suite.h"

namespace candela::cli {

// The options of bench, as text until all are read.
struct BenchOptions {
  std::vector<std::string> what;  // suite files and scenes
  std::string suite, stability_file, techniques, transparency, lights, sizes, samples, qualities, times, frames,
      fps = "24", output, reference, camera, sky, look, assets, report, json, csv, device, only, pictures;
  std::vector<std::string> settings, effects, compare, from;
  std::optional<uint64_t> seed;
  std::optional<double> budget_s, precision, warm_up_s, no_slower_percent;
  std::optional<int> min_runs, max_runs, max_sessions, count, reference_max_lights, views;
  double min_change = 0.05, timeout_s = 600;
  bool error = false;  // sweep of error against time
  std::string hdr_flip = "auto";
  std::optional<uint64_t> reference_spp;
  double reference_s = 0;
  bool validate = false, quiet = false, large = false, resume = false;
};
void add_bench_options(CLI::App& command, BenchOptions& options);

// A technique by its name, which may be auto: what it is on the device (gpu/device.h, DeviceOptions).
Expected<std::string> technique_named(const std::string& name, const std::string& device);
// A suite file that chooses among the scenes of --suite stability, named instead of it.
Expected<void> take_stability_file(BenchOptions& options);
// That options which ask for different things are not given together.
Expected<void> check_options(const BenchOptions& options);
// The suites named, and one of the scenes named, with the options put over what suites say.
Expected<std::vector<Suite>> suites_of(const BenchOptions& options);
Expected<ExactnessOptions> exactness_of(const BenchOptions& options);
Expected<StillnessOptions> stillness_of(const BenchOptions& options);
Expected<ErrorSweepOptions> error_sweep_of(const BenchOptions& options);
RunSettings bench_settings(const BenchOptions& options);

}  // namespace candela::cli
