#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/statistics.h"
#include "job/job.h"
#include "session/session.h"

namespace candela {

// Searches the settings of one scene at one size on one device for the cheapest at some errors and the most exact at
// some times, within a time.
struct TuneOptions {
  Job job;  // its technique, quality, samples and settings are what is searched for
  double moment_s = 0;
  double seconds = 120;  // of all of it, opening and the traced reference too; a frame that was begun is finished
  bool picture = false;  // one frame more, for the report's picture
};

struct TuneTrial {
  Job job;
  std::string options;          // as for render: "--technique clustered --quality high --set fog.grid=32x18x24"
  std::vector<double> gpu_ms;   // sums of the passes of each frame
  std::vector<size_t> moments;  // of each: how often the clock setting had been measured before
  Interval ms;                  // 95 % of their median, as settle_times() has it
  double median_ms = 0;
  double relmse = 0, flip = 0;  // against the traced reference
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
  std::string reference;  // that errors are against (error_truth.h)
  uint64_t reference_spp = 0;
  double reference_ms = 0;         // wall time of one sample a pixel; 0: not known
  double noise = 0;                // relmse that its noise makes: smaller differences of errors say nothing
  std::vector<std::string> notes;  // what was not found out
  double wall_s = 0;
  std::vector<std::byte>
      picture;  // PNG of the most exact setting on the front, as it is displayed; of at most 480 pixels
};

// Techniques at quality high, and the qualities of the quickest, at full size. Then a search in small pictures of that
// technique: every knob a step either way, then, from one setting after another on the front of error against time, the
// knobs that changed something. What is on that front is measured at full size, and in rounds for as long as there is
// time. Settings that plan the same work are one. Errors: the scene, the device, or no reference.
Expected<TuneReport> tune(const TuneOptions& options, const RunSettings& settings, const std::function<bool()>& stop);

// Medians and intervals of the trials' times. clock_ms: one setting, measured again beside the others. Where it changed
// by more than a quarter over the search, as clocks and other load do, each sample is taken as it would have been at
// the clock setting's median: times the ratio of that to the clock setting's own time then. The note that says so;
// empty where nothing changed.
std::string settle_times(std::vector<TuneTrial>& trials, std::span<const double> clock_ms);

// Trials that no other one beats in both time and error, the fastest first.
std::vector<const TuneTrial*> tune_front(const TuneReport& report);
// Of the front's quickest setting that the reference beats: what makes no larger error in less time, for its error is
// noise, which falls with its samples. Empty where there is none, or the noise or the time is not known.
std::string quicker_reference(const TuneReport& report);
// The cheapest with at most each error; and the one with the least error within each time (by the upper end of its
// interval), or a quicker one whose error cannot be told apart from that.
std::vector<TuneChoice> cheapest_within(const TuneReport& report, std::span<const double> errors);
const TuneTrial* least_error(const TuneReport& report);  // null where nothing was measured
std::vector<TuneChoice> most_exact_within(const TuneReport& report, std::span<const double> ms);

}  // namespace candela
