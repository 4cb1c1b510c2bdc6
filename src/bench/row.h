#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "bench/sampling.h"
#include "metrics/hdr_flip.h"
#include "metrics/noise_floor.h"

namespace candela {

// Raw samples of one quantity, in the order in which they were taken.
struct Series {
  std::string name;
  std::vector<double> ms;
};
Series& series(std::vector<Series>& all, const std::string& name);  // made when it is not there

// How often lights stand in the lists that pixels walk (layers heatmap_*). "Lights per tile", weighted by pixels.
struct LightLists {
  double mean = 0, p95 = 0, max = 0;
  double waste_fraction = 0;  // of listed lights: those that contribute nothing
  double missed = 0;          // lights that contribute and are not listed, over all pixels: must be 0
};

// The picture against the reference's.
struct PictureCheck {
  std::string reference;   // technique; empty: not compared
  std::string note;        // why it was not compared, or not against the suite's reference
  uint64_t differing = 0;  // pixels whose linear colour is not bit-equal
  double max_difference = 0;
};

// Of one view.
struct ViewError {
  std::map<std::string, double> metrics;  // names as in metrics/compare.h
  std::optional<NoiseFloor> noise;        // of the reference
};

// How far the picture is from one that is truer (error_sweep.h says which there are).
struct PictureError {
  std::string reference;
  // Over the views (error_views.h); empty where it was not compared.
  std::map<std::string, double> metrics;
  std::string note;                        // why not
  std::optional<NoiseFloor> noise;         // of the reference, over the views
  std::vector<ViewError> views;            // each; empty where there is but one
  std::optional<ExposureRange> exposures;  // of hdr-flip: the same for all rows of a place
  uint64_t spp = 0;                        // of a traced reference
};

// A knob's value that the row is measured at, all else being exact: a point of that knob's study.
struct KnobPoint {
  std::string knob, value;          // "lights.floor_lux", "0.1"
  std::string kind;                 // what the knob trades: error or time
  std::vector<std::string> passes;  // whose work it changes
};

// What else plans the same work as a row: it is not measured again.
struct SameWork {
  std::string suite, technique, quality, settings, job;
  std::vector<KnobPoint> knobs;
  std::optional<PictureError> exact;  // against its own technique's exact picture, where that is another technique's
};

// One configuration as measured. Every number of a report is here or follows from it.
struct BenchRow {
  // What was measured.
  std::string suite, scene, scene_content, technique, settings, quality, effects, sky, look, output;
  std::string transparency = "sorted";
  uint64_t seed = 0;
  int64_t lights = -1;         // that shine in the frame; -1: unknown
  int64_t lights_wanted = -1;  // asked of a generated scene; -1: its own number
  std::string camera;
  int width_px = 0, height_px = 0, samples = 0;
  double time_s = 0;
  int views = 1;  // over which times and errors are means (error_views.h)
  int run = 0;    // rows of one run were measured in the same rounds
  // Of each sample: the round that it is of, from 1; or a moment between rounds, below 0, which it shares with a row
  // that was measured again beside it. Empty: sample i is of round i + 1.
  std::vector<int> rounds;
  // The traced reference that holds what the frame claims to draw (error_truth.h): settings are judged by it.
  std::string truth;
  std::vector<SameWork> same_work;
  // Where.
  std::string device, driver, device_class, device_type, machine, version;
  std::string source;  // of the program: as --version says it; empty: not recorded
  int cores = 0;
  // How.
  std::string plan_hash, knob_hash, job;  // job: JSON
  int warm_up_frames = 0;
  bool runs_capped = false;  // the precision wanted would have needed more runs
  bool budget_hit = false;   // time ran out first
  bool reopened = false;     // memory did not allow to keep it open between rounds
  // Times. gpu is the sum of the passes, frame the wall time from the scene's pose to bytes in host memory.
  Series gpu, frame;
  std::vector<Series> passes, cpu;
  std::vector<std::pair<std::string, double>> opening_ms;  // load and upload, once
  std::vector<std::pair<std::string, uint64_t>> memory;    // bytes, as in --timings
  std::vector<std::pair<std::string, uint64_t>> trees;     // for rays: how many of what; empty: none are sent
  PictureCheck picture;
  std::vector<PictureError> errors;  // of sweeps of error against time
  std::vector<KnobPoint> knobs;      // the same: one, or at the exact end of all knobs many
  std::optional<LightLists> lists;
  std::string lists_note;            // why there are none
  std::vector<std::string> remarks;  // what the frame's own notes and warnings say
  std::string left_out;              // the whole configuration was not measured, and why
  std::string error;                 // it failed
  int error_kind = 0;
  std::vector<std::byte> thumbnail, heatmap;  // PNG; in reports, not in files of rows
  std::vector<std::byte> strip;               // the same: picture of the reference, this one, and their FLIP
};

// ", sky S, look L, effects E, transparency T", as far as they are not the defaults.
std::string row_look(const BenchRow& row);
// Names what the row measured, without the device: equal for the same configuration in another run.
std::string row_key(const BenchRow& row);
// The same for readers: "street, 1024 lights, clustered, 1280x720, 4 samples".
std::string row_title(const BenchRow& row);
// A technique with its settings: what a line in a plot stands for.
std::string row_way(const BenchRow& row);
// Everything but the number of lights, the technique and the device: "street, 1280x720, 4 samples".
std::string row_setting(const BenchRow& row);
// Where it was measured: device, on a CPU device the processor, driver.
std::string row_device(const BenchRow& row);
// Both: rows of one axis may share axes.
std::string row_axis(const BenchRow& row);

// What became of each row of `before` in `after`.
struct RowChange {
  std::string title, quantity;  // "gpu", "frame" or a pass
  Judgement judgement;
};
struct RowComparison {
  std::vector<RowChange> changes;                               // everything judged, in the new file's order
  std::vector<std::string> only_old, only_new, not_comparable;  // titles; the last with a reason
  std::vector<std::string> worse_pictures;  // differ from their reference in more pixels than before
  // Of each row that both have: frame times, and how many times as long the new one takes, sure for all rows together.
  struct Ratio {
    std::string title;
    double middle = 0;  // of the medians
    Interval ratio;
  };
  std::vector<Ratio> frames;
  bool slower() const;
};
// Errors (input): rows of different devices or machines, which say nothing about each other.
Expected<RowComparison> compare_rows(const std::vector<BenchRow>& before, const std::vector<BenchRow>& after,
                                     const NoiseRules& rules);

}  // namespace candela
