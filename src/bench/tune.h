#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/statistics.h"
#include "frame/job.h"
#include "frame/session.h"

namespace candela {

// Searches the settings of one scene at one size on one device for the cheapest at some errors and the most exact at
// some times, within a time.
struct TuneOptions {
  Job job;  // its technique, quality, samples and settings are what is searched for
  double moment_s = 0;
  double seconds = 120;  // of the whole search; a frame that was begun is finished
  bool picture = false;  // one frame more, for the report's picture
};

struct TuneTrial {
  Job job;
  std::string options;         // as for render: "--technique clustered --quality high --set fog.grid=32x18x24"
  std::vector<double> gpu_ms;  // sums of the passes of each frame
  Interval ms;                 // 95 % of their median
  double median_ms = 0;
  double relmse = 0, flip = 0;  // against the exact picture
  std::string same_as;          // options of a trial that plans the same passes and gives the same picture
  std::string failed;           // it could not be rendered, and why
  bool usable() const { return failed.empty() && same_as.empty() && !gpu_ms.empty(); }
};

struct TuneChoice {
  double wanted = 0;                 // an error (relmse), or milliseconds
  const TuneTrial* trial = nullptr;  // null: none is that good or that fast
};

struct TuneReport {
  std::vector<TuneTrial> trials;
  std::string device;
  int error_width_px = 0, error_height_px = 0;  // of the pictures that errors are of
  double exact_ms = 0;                          // wall time of a frame of the exact picture
  std::vector<std::string> notes;               // what was not found out
  double wall_s = 0;
  std::vector<std::byte>
      picture;  // PNG of the most exact setting on the front, as it is displayed; of at most 480 pixels
};

// Quality presets of all techniques first, then single knobs of the best technique's, then what helped together, then
// more frames of those that are on the front. Errors: the scene, the device, or no exact picture.
Expected<TuneReport> tune(const TuneOptions& options, const RunSettings& settings, const std::function<bool()>& stop);

// Trials that no other one beats in both time and error, the fastest first.
std::vector<const TuneTrial*> tune_front(const TuneReport& report);
// The cheapest with at most each error, and the one with the least error within each time (by the upper end of its
// interval).
std::vector<TuneChoice> cheapest_within(const TuneReport& report, std::span<const double> errors);
std::vector<TuneChoice> most_exact_within(const TuneReport& report, std::span<const double> ms);

}  // namespace candela
