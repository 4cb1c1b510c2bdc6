#pragma once
#include <CLI/CLI.hpp>
#include <charconv>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "job/job.h"

namespace candela::cli {

// The options that render, sequence, plan and facts share, as text until all are read. add_* are the only place where
// an option's name, help and default stand.
struct JobOptions {
  std::string scene, up = "y", animation = "auto", camera, eye, target, size = "1280x720", technique = "auto",
                     transparency = "auto", sides = "auto", quality = "high", effects = "auto", sky = "auto", look,
                     shading = "pbr", cut_outs = "blended", variant, probe, tonemap, view = "beauty", layers,
                     background = "transparent", exr_type = "half", exr_compression = "zip", fps = "24", device,
                     shader_folder, config, region, overscan, camera_path;
  std::vector<std::string> settings, light_groups, paths, instances;
  std::optional<double> yfov_deg, azimuth_deg, elevation_deg;
  bool fit = false, follow = false;
  int turntable = 0;  // frames of a turn
  int samples = 0, png_bits = 8, queues = 2;
  std::string shutter, focus;
  std::optional<double> f_stop, sensor_mm, iso;
  int subframes = 0;             // 0: as the quality says
  std::string exposure, strict;  // none (empty), loss or all
  uint64_t seed = 0;
  bool no_dither = false, metadata_timings = false, allow_nonfinite = false, allow_blank = false, validate = false,
       allow_cpu = false, quiet = false, verbose = false, json = false;
  double timeout_s = 600;
};

// --frame and --time of commands that take one moment.
struct MomentOptions {
  int64_t frame = 0;
  double time_s = 0;
  CLI::Option *frame_option = nullptr, *time_option = nullptr;
};

// Takes decimal numbers within T alone: CLI11 itself clamps or wraps what does not fit and reads a leading 0 as octal.
template <typename T>
CLI::Validator whole_number() {
  const auto canonical = [](std::string& text) -> std::string {
    T value{};
    const char* end = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc{} || at != end)
      return fmt::format("'{}' is not a whole number from {} to {}", text, std::numeric_limits<T>::min(),
                         std::numeric_limits<T>::max());
    text = std::to_string(value);
    return {};
  };
  return {canonical, ""};
}

// CLI11's own print the ends of their range, which are of 300 digits.
CLI::Validator positive_number();
CLI::Validator non_negative_number();

// The reference takes what says which picture is meant and how it is written, but not how the GPU makes it.
enum class Renderer { gpu, reference, none };  // none: what decides what is there, and nothing of the picture
void add_job_options(CLI::App& command, JobOptions& options, Renderer renderer = Renderer::gpu);
void add_run_options(CLI::App& command, JobOptions& options,
                     Renderer renderer = Renderer::gpu);  // device, validation, log
void add_strict_option(CLI::App& command, JobOptions& options);
void add_moment_options(CLI::App& command, MomentOptions& moment);

// Fills options that the command line left out from --config FILE. Unknown names are errors. Call after parsing.
Expected<void> read_config(CLI::App& command, const std::string& file);

Expected<Job> job_of(const JobOptions& options);                   // checked
Expected<RunSettings> run_settings_of(const JobOptions& options);  // checked
void set_log_level(const JobOptions& options);

struct Moment {
  std::optional<int64_t> frame;  // absent when a time was given
  FrameRate rate;
  double time_s = 0;
};
// A list of frames as it was given, or for "all" the frames from 0 to the last key of the animations that play.
Expected<std::string> with_all_frames(const std::string& frames, const Job& job, const std::string& fps);
Expected<Moment> moment_of(const JobOptions& options, const MomentOptions& moment);

}  // namespace candela::cli
