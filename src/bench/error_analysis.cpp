#include "bench/error_analysis.h"

#include <charconv>

#include "bench/error_truth.h"

namespace candela {
namespace {

double median_ms(const BenchRow& row) { return summary(row.gpu.ms).median; }

// How well a fit explains the logarithms: the share of their variance.
double r_squared(const PowerFit& fit, std::span<const double> x, std::span<const double> y) {
  double mean = 0, total = 0, left = 0;
  for (const double v : y) mean += std::log(v) / double(y.size());
  for (size_t i = 0; i < x.size(); ++i) {
    const double log_y = std::log(y[i]), fitted = std::log(fit.factor) + fit.exponent * std::log(x[i]);
    total += (log_y - mean) * (log_y - mean), left += (log_y - fitted) * (log_y - fitted);
  }
  return total > 0 ? 1 - left / total : 1;
}

void fit_order(KnobStudy& study) {
  std::vector<double> x, y;
  for (const KnobStudy::Value& v : study.values)
    if (v.value > 0 && v.rmse > 0) x.push_back(v.value), y.push_back(v.rmse);
  study.fit = fit_power(x, y);
  if (study.fit.points >= 2) study.r_squared = r_squared(study.fit, x, y);
}

// Beyond doubt: the 95 % confidence intervals of the medians do not meet.
bool surely_quicker(const Interval& a, const Interval& b) { return a.high < b.low; }

void find_dominated(KnobStudy& study) {
  for (KnobStudy::Value& v : study.values)
    for (const KnobStudy::Value& other : study.values)
      if (!v.dominated && other.relmse <= v.relmse && surely_quicker(other.ms_ci, v.ms_ci)) {
        v.dominated = true;
        v.verdict = "no: " + other.text + " is quicker and no worse";
      }
}

// Of values that all give the same picture: the one that presets take, unless another is quicker beyond doubt.
void judge_times(KnobStudy& study) {
  find_dominated(study);
  const KnobStudy::Value* best = &study.values.back();
  for (KnobStudy::Value& v : study.values) {
    if (!v.dominated) v.verdict = "no other is quicker beyond doubt";
    if (surely_quicker(v.ms_ci, best->ms_ci)) best = &v;
  }
  study.advised = best->text;
}

// A tenth of what is wrong anyway is not seen: the cheapest value whose own error stays below it is the one worth its
// time; among values whose times are not known to differ, the one with less error.
void judge_values(KnobStudy& study, std::optional<double> model_relmse) {
  const auto& values = study.values;
  if (study.kind == "time") return judge_times(study);
  if (std::all_of(values.begin(), values.end(), [](const KnobStudy::Value& v) { return v.rmse == 0; })) {
    for (KnobStudy::Value& v : study.values) v.verdict = "changes nothing in this picture";
    return;
  }
  find_dominated(study);
  const KnobStudy::Value* best = nullptr;
  for (KnobStudy::Value& v : study.values) {
    const bool hidden = model_relmse ? v.relmse <= 0.1 * *model_relmse : v.relmse == 0;
    if (!v.dominated) v.verdict = hidden ? "its error is hidden under the technique's own" : "its error shows";
    if (!hidden) continue;
    if (!best || surely_quicker(v.ms_ci, best->ms_ci) ||
        (!surely_quicker(best->ms_ci, v.ms_ci) && v.relmse < best->relmse))
      best = &v;
  }
  if (best) study.advised = best->text;
}

const BenchRow* exact_row(std::span<const BenchRow* const> rows, const std::string& technique) {
  for (const BenchRow* row : rows)
    if (row->suite == "whole" && row->quality == "exact" && row->technique == technique) return row;
  return nullptr;
}

}  // namespace

std::string error_place(const BenchRow& row) {
  std::string place = row.scene;
  const int64_t lights = row.lights_wanted >= 0 ? row.lights_wanted : row.lights;
  if (lights >= 0) place += fmt::format(", {} light{}", lights, lights == 1 ? "" : "s");
  place += fmt::format(", {}x{}", row.width_px, row.height_px);
  if (!row.camera.empty()) place += ", camera " + row.camera;
  if (row.time_s != 0) place += fmt::format(", at {} s", row.time_s);
  return place + ", " + row.device;
}

std::string error_setting(const BenchRow& row) {
  return fmt::format("{}, quality {}{}{}", row.technique, row.quality, row.settings.empty() ? "" : ", ", row.settings);
}

const PictureError* error_against(const BenchRow& row, const std::string& reference) {
  for (const PictureError& error : row.errors)
    if (error.reference == reference) return &error;
  return nullptr;
}

std::optional<double> error_of(const BenchRow& row, const std::string& reference, const std::string& metric) {
  const PictureError* error = error_against(row, reference);
  if (!error || row.gpu.ms.empty()) return {};
  const auto found = error->metrics.find(metric);
  return found != error->metrics.end() && std::isfinite(found->second) ? std::optional(found->second) : std::nullopt;
}

std::vector<ErrorPoint> error_points(std::span<const BenchRow* const> rows, const std::string& reference,
                                     const std::string& metric) {
  std::vector<ErrorPoint> points;
  for (const BenchRow* row : rows)
    if (const auto error = error_of(*row, reference, metric))
      points.push_back({row, median_ms(*row), *error, median_interval(row->gpu.ms)});
  for (ErrorPoint& p : points)
    p.dominated = std::any_of(points.begin(), points.end(), [&](const ErrorPoint& q) {
      return q.ms <= p.ms && q.error <= p.error && (q.ms < p.ms || q.error < p.error);
    });
  return points;
}

const BenchRow* cheapest(std::span<const BenchRow* const> rows, const std::string& reference, const std::string& metric,
                         double most) {
  const ErrorPoint* best = nullptr;
  const auto points = error_points(rows, reference, metric);
  for (const ErrorPoint& p : points)
    if (p.error <= most && (!best || std::pair(p.ms, p.error) < std::pair(best->ms, best->error))) best = &p;
  if (!best) return nullptr;
  if (best->row->settings.empty()) return best->row;
  // A quality by its name is easier to ask for than one knob of it, where they are the same.
  const ErrorPoint* named = nullptr;
  for (const ErrorPoint& p : points)
    if (p.row->settings.empty() && p.error <= best->error && !surely_quicker(best->ms_ci, p.ms_ci) &&
        (!named || std::pair(p.ms, p.error) < std::pair(named->ms, named->error)))
      named = &p;
  if (named) return named->row;
  return best->row;
}

std::string cheapest_sentence(std::span<const BenchRow* const> rows, const std::string& reference,
                              const std::string& metric, double most) {
  const BenchRow* row = cheapest(rows, reference, metric, most);
  if (!row) return fmt::format("no setting has {} below {} against {}", metric, most, reference);
  const double error = *error_of(*row, reference, metric);
  const Interval ci = median_interval(row->gpu.ms);
  std::string text = fmt::format(
      "for {} below {} against {} the cheapest setting is {}: {:.3g} ms on the GPU (95 % CI {:.3g} to {:.3g}), {} "
      "{:.3g}",
      metric, most, reference, error_setting(*row), median_ms(*row), ci.low, ci.high, metric, error);
  if (const auto& noise = error_against(*row, reference)->noise; noise && metric == "relmse" && error <= noise->relmse)
    text += fmt::format(", which is below the reference's own noise of {:.3g}", noise->relmse);
  return text;
}

std::vector<double> passes_ms(const BenchRow& row, const std::vector<std::string>& passes) {
  std::vector<double> sums;
  for (const Series& pass : row.passes) {
    if (std::find(passes.begin(), passes.end(), pass.name) == passes.end()) continue;
    sums.resize(std::max(sums.size(), pass.ms.size()));
    for (size_t i = 0; i < pass.ms.size(); ++i) sums[i] += pass.ms[i];
  }
  return sums;
}

uint64_t memory_of(const BenchRow& row, std::string_view name) {
  for (const auto& [key, bytes] : row.memory)
    if (key == name) return bytes;
  return 0;
}

std::vector<KnobStudy> knob_studies(std::span<const BenchRow* const> rows) {
  std::vector<KnobStudy> studies;
  const auto add = [&](const BenchRow& row, const KnobPoint& point) {
    const auto relmse = error_of(row, exact_reference, "relmse"), rmse = error_of(row, exact_reference, "rmse");
    if (!relmse || !rmse) return;
    auto found = std::find_if(studies.begin(), studies.end(),
                              [&](const KnobStudy& s) { return s.knob == point.knob && s.technique == row.technique; });
    KnobStudy& study =
        found == studies.end()
            ? studies.emplace_back(KnobStudy{point.knob, row.technique, point.kind, point.passes, {}, {}, 0, {}})
            : *found;
    KnobStudy::Value value{.row = &row, .text = point.value, .relmse = *relmse, .rmse = *rmse};
    std::from_chars(value.text.data(), value.text.data() + value.text.size(), value.value);
    value.ms = median_ms(row), value.ms_ci = median_interval(row.gpu.ms);
    const std::vector<double> passes = passes_ms(row, point.passes);
    value.passes_ms = median(passes), value.passes_ci = median_interval(passes);
    study.values.push_back(std::move(value));
  };
  for (const BenchRow* row : rows)
    if (row->suite != "whole")
      for (const KnobPoint& point : row->knobs) add(*row, point);
  // The exact end of every knob is one row: the technique's own.
  for (const BenchRow* row : rows)
    if (row->suite == "whole")
      for (const KnobPoint& point : row->knobs) add(*row, point);
  for (KnobStudy& study : studies) {
    fit_order(study);
    const BenchRow* exact = exact_row(rows, study.technique);
    // Trimmed: a firefly of the technique's must not hide what a knob does everywhere else.
    std::optional<double> model;
    if (exact) model = error_of(*exact, open_reference_name, "relmse-trimmed");
    if (exact && !model) model = error_of(*exact, open_reference_name, "relmse");
    judge_values(study, model);
  }
  return studies;
}

std::vector<TotalError> total_errors(std::span<const BenchRow* const> rows, const std::string& reference) {
  std::vector<TotalError> totals;
  for (const BenchRow* row : rows) {
    if (row->suite != "whole") continue;
    const BenchRow* exact = exact_row(rows, row->technique);
    const auto total = error_of(*row, reference, "relmse"), sampling = error_of(*row, exact_reference, "relmse");
    const auto model = exact ? error_of(*exact, reference, "relmse") : std::nullopt;
    if (total && sampling && model) totals.push_back({row, reference, *total, *model, *sampling});
  }
  return totals;
}

std::vector<NoiseVerdict> noise_verdicts(std::span<const BenchRow* const> rows) {
  std::vector<NoiseVerdict> verdicts;
  for (const std::string& reference : error_reference_names()) {
    NoiseVerdict verdict{.reference = reference};
    bool any = false;
    for (const BenchRow* row : rows) {
      const auto error = error_of(*row, reference, "relmse");
      const PictureError* against = error_against(*row, reference);
      if (!error || !against->noise) continue;
      verdict.smallest = any ? std::min(verdict.smallest, *error) : *error;
      verdict.floor = against->noise->relmse, verdict.spp = against->spp;
      any = true;
    }
    if (!any) continue;
    verdict.enough = verdict.floor <= 0.1 * verdict.smallest;
    verdict.sentence = fmt::format(
        "{} was traced with {} samples a pixel: its noise makes a relmse of {:.3g}; the smallest error against it is "
        "{:.3g}, {}",
        reference, verdict.spp, verdict.floor, verdict.smallest,
        verdict.enough ? "at least ten times as much"
                       : "less than ten times as much: take more samples (--reference-spp) before small differences "
                         "against it are believed");
    verdicts.push_back(std::move(verdict));
  }
  return verdicts;
}

std::vector<std::string> error_defects(std::span<const BenchRow* const> rows) {
  std::vector<std::string> defects;
  for (const BenchRow* row : rows) {
    if (row->suite == "whole" || row->knobs.empty() || row->knobs.front().kind != "time") continue;
    if (const auto differing = error_of(*row, exact_reference, "differing"); differing && *differing > 0)
      defects.push_back(fmt::format("{}, {}: {} must change nothing but time, and {:.0f} pixels differ",
                                    error_place(*row), row->technique,
                                    row->knobs.front().knob + "=" + row->knobs.front().value, *differing));
  }
  return defects;
}

}  // namespace candela
