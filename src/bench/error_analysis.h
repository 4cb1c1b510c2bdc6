#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/statistics.h"
#include "bench/row.h"

namespace candela {

// What rows of an error sweep say; all of it follows from the rows, so that a kept file gives the same report.

// Scene, lights, camera, size, time, views and device: rows of one place share references and axes.
std::string error_place(const BenchRow& row);
// "forward-plus, quality draft, lights.floor_lux=0.1".
std::string error_setting(const BenchRow& row);
// The same with what plans the same work: "clustered, quality draft = forward-plus, quality draft".
std::string error_names(const BenchRow& row);
const PictureError* error_against(const BenchRow& row, const std::string& reference);
// The reference that a row is judged by: the one it names; of files that name none, `direct` unless the row leaves out
// all effects or was not compared with it.
std::string truth_of(const BenchRow& row);
// Of rows of one place: that of the first of them which was measured.
std::string truth_of(std::span<const BenchRow* const> rows);
// nullopt where the row was not measured or not compared, or the value is not finite.
std::optional<double> error_of(const BenchRow& row, const std::string& reference, const std::string& metric);

struct ErrorPoint {
  const BenchRow* row = nullptr;
  double ms = 0, error = 0;  // median GPU time; a metric where less is better, over the row's views
  Interval ms_ci, error_ci;  // 95 %
  // dominated: another is surely quicker and no worse. unclear: by its numbers another is no slower and no worse, which
  // is not sure: the two are not distinguishable. front: neither.
  enum class Standing { front, unclear, dominated } standing = Standing::front;
  const BenchRow* by = nullptr;  // that other
};
std::vector<ErrorPoint> error_points(std::span<const BenchRow* const> rows, const std::string& reference,
                                     const std::string& metric);
const char* standing_name(ErrorPoint::Standing standing);

// A setting over all places (cameras, times) of the rows: the worst counts. Only those that every place has.
struct SettingPoint {
  const BenchRow* row = nullptr;  // where it takes longest
  double ms = 0, error = 0;
  Interval ms_ci, error_ci;
};
std::vector<SettingPoint> setting_points(std::span<const BenchRow* const> rows, const std::string& reference,
                                         const std::string& metric);
// The cheapest setting whose error is surely no more than `most` (the upper end of its interval): the one and only
// choice, of the report and of a render. A quality is taken rather than one knob of it that is not surely quicker.
const SettingPoint* cheapest(std::span<const SettingPoint> settings, double most);
// The most exact that surely takes no longer; of those whose errors cannot be told apart from its, the quickest.
const SettingPoint* most_exact(std::span<const SettingPoint> settings, double most_ms, const std::string& reference,
                               const std::string& metric);

// "for relmse below 0.01 against direct the cheapest setting is ...", or that none reaches it; empty where nothing was
// measured against it.
std::string cheapest_sentence(std::span<const BenchRow* const> rows, const std::string& reference,
                              const std::string& metric, double most);

// Of each bound, which become smaller, against the rows' truth; bounds that one setting meets are one sentence, the
// tightest, and the first that none meets is the last.
std::vector<std::string> cheapest_sentences(std::span<const BenchRow* const> rows, std::span<const double> bounds);
// A value to three digits, or as many as it takes to see on which side of the bound it lies.
std::string bounded_text(double value, double bound);

// Samples of the time of some passes together; empty where the row has none of them.
std::vector<double> passes_ms(const BenchRow& row, const std::vector<std::string>& passes);
// Bytes of what the row's memory calls so; 0 when it says nothing.
uint64_t memory_of(const BenchRow& row, std::string_view name);

// One knob of one technique along its values, at one place. Errors are relmse and rmse against the technique's exact
// picture.
struct KnobStudy {
  struct Value {
    const BenchRow* row = nullptr;
    std::string text;
    double value = 0, ms = 0, relmse = 0, rmse = 0;
    Interval ms_ci, relmse_ci;
    double passes_ms = 0;  // of the passes that the knob belongs to
    Interval passes_ci;
    bool dominated = false;  // another value is surely quicker and no worse
    std::string verdict;     // whether it is worth its time, and why
  };
  std::string knob, technique, kind;  // kind: what it trades, error or time
  std::vector<std::string> passes;
  std::vector<Value> values;  // the exact one last
  // rmse = factor * value^exponent over the values that have an error; the knob's order of convergence where it has
  // three or more.
  PowerFit fit;
  double r_squared = 0;
  std::string advised;  // the value worth its time; empty where none is, or the knob changes nothing
};
// rows: of one place.
std::vector<KnobStudy> knob_studies(std::span<const BenchRow* const> rows);

// A technique's error at a quality, and what it is made of: the model's is that of the same technique at its exact end,
// the sampling's is the distance from there. They need not add up: errors may cancel. All are relmse.
struct TotalError {
  const BenchRow* row = nullptr;
  std::string reference;
  double total = 0, model = 0, sampling = 0;
};
std::vector<TotalError> total_errors(std::span<const BenchRow* const> rows, const std::string& reference);

// Whether a traced reference is good enough for the errors that are reported against it.
struct NoiseVerdict {
  std::string reference;
  double floor = 0, smallest = 0;  // relmse
  uint64_t spp = 0;
  bool enough = false;  // the floor is at most a tenth of the smallest error
  std::string sentence;
};
std::vector<NoiseVerdict> noise_verdicts(std::span<const BenchRow* const> rows);

// Rows whose knob may change nothing but time, and which differ from the technique's exact picture: each is a defect of
// the program.
std::vector<std::string> error_defects(std::span<const BenchRow* const> rows);

// The rows, and after each what plans the same work, as rows of their own names with its samples: for tables that ask
// by technique, quality or knob.
std::vector<BenchRow> rows_by_name(std::span<const BenchRow* const> rows);

// Knobs of all passes that are no point of any row, each with the reason where the table knows one.
std::vector<std::string> unswept_knobs(const std::vector<BenchRow>& rows);

}  // namespace candela
