#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/row.h"

namespace candela {

// What rows of an error sweep say; all of it follows from the rows, so that a kept file gives the same report.

// Scene, lights, camera, size, time and device: rows of one place share references and axes.
std::string error_place(const BenchRow& row);
// "forward-plus, quality draft, lights.floor_lux=0.1".
std::string error_setting(const BenchRow& row);
const PictureError* error_against(const BenchRow& row, const std::string& reference);
// nullopt where the row was not measured or not compared, or the value is not finite.
std::optional<double> error_of(const BenchRow& row, const std::string& reference, const std::string& metric);

struct ErrorPoint {
  const BenchRow* row = nullptr;
  double ms = 0, error = 0;  // median GPU time; a metric where less is better
  bool dominated = false;    // another is no slower and no worse, and better in one of them
};
std::vector<ErrorPoint> error_points(std::span<const BenchRow* const> rows, const std::string& reference, const std::string& metric);

// The cheapest row whose error is no more than `most`; among equals the more exact, or a quality rather than one knob of it.
const BenchRow* cheapest(std::span<const BenchRow* const> rows, const std::string& reference, const std::string& metric, double most);
// The most exact row that takes no more than `ms`.
const BenchRow* most_exact(std::span<const BenchRow* const> rows, const std::string& reference, const std::string& metric, double ms);
// "for relmse below 0.01 against direct the cheapest setting is ...", or that none reaches it.
std::string cheapest_sentence(std::span<const BenchRow* const> rows, const std::string& reference, const std::string& metric, double most);

// One knob along its ladder, at one place. Errors are relmse and rmse against the exact picture.
struct KnobStudy {
  struct Value {
    const BenchRow* row = nullptr;
    std::string text;
    double value = 0, ms = 0, mad_ms = 0, relmse = 0, rmse = 0;
    bool dominated = false;  // another value is quicker beyond doubt and no worse
    std::string verdict;     // whether it is worth its time, and why
  };
  std::string knob;
  std::vector<Value> values;
  // rmse = factor * value^exponent over the values that have an error; the knob's order of convergence where it has three or more.
  PowerFit fit;
  double r_squared = 0;
  std::string advised;  // the value worth its time; empty where none is, or the knob changes nothing
};
// rows: of one place.
std::vector<KnobStudy> knob_studies(std::span<const BenchRow* const> rows);

}  // namespace candela
