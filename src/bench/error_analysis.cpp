#include "bench/error_analysis.h"

#include <charconv>

#include "bench/error_sweep.h"

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

// Medians that are no farther apart than this are not known to differ: three standard errors (sampling.h) of each.
double doubt_ms(const BenchRow& a, const BenchRow& b) {
  const auto error = [](const BenchRow& row) {
    const Summary s = summary(row.gpu.ms);
    return s.count > 0 ? 1.2533 * 1.4826 * s.mad / std::sqrt(double(s.count)) : 0;
  };
  return 3 * std::hypot(error(a), error(b));
}

// A tenth of what is wrong anyway is not seen: the cheapest value whose own error stays below it is the one worth its time; among values
// whose times are not known to differ, the one with less error.
void judge_values(KnobStudy& study, std::optional<double> whole_relmse) {
  const auto& values = study.values;
  if (std::all_of(values.begin(), values.end(), [](const KnobStudy::Value& v) { return v.rmse == 0; })) {
    for (KnobStudy::Value& v : study.values) v.verdict = "changes nothing in this picture";
    return;
  }
  const KnobStudy::Value* best = nullptr;
  for (KnobStudy::Value& v : study.values) {
    for (const KnobStudy::Value& other : study.values)
      if (other.relmse <= v.relmse && other.ms < v.ms - doubt_ms(*other.row, *v.row)) {
        v.dominated = true;
        v.verdict = "no: " + other.text + " is quicker and no worse";
        break;
      }
    const bool hidden = whole_relmse ? v.relmse <= 0.1 * *whole_relmse : v.relmse == 0;
    if (!v.dominated) v.verdict = hidden ? "its error is hidden under the technique's own" : "its error shows";
    if (!hidden) continue;
    const double doubt = best ? doubt_ms(*v.row, *best->row) : 0;
    if (!best || v.ms < best->ms - doubt || (v.ms < best->ms + doubt && v.relmse < best->relmse)) best = &v;
  }
  if (best) study.advised = best->text;
}

std::string setting_value(const BenchRow& row, const std::string& knob) {
  const std::string key = knob + "=";
  return row.settings.starts_with(key) ? row.settings.substr(key.size()) : std::string();
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

std::vector<ErrorPoint> error_points(std::span<const BenchRow* const> rows, const std::string& reference, const std::string& metric) {
  std::vector<ErrorPoint> points;
  for (const BenchRow* row : rows)
    if (const auto error = error_of(*row, reference, metric)) points.push_back({row, median_ms(*row), *error});
  for (ErrorPoint& p : points)
    p.dominated = std::any_of(points.begin(), points.end(), [&](const ErrorPoint& q) {
      return q.ms <= p.ms && q.error <= p.error && (q.ms < p.ms || q.error < p.error);
    });
  return points;
}

const BenchRow* cheapest(std::span<const BenchRow* const> rows, const std::string& reference, const std::string& metric, double most) {
  const ErrorPoint* best = nullptr;
  const auto points = error_points(rows, reference, metric);
  for (const ErrorPoint& p : points)
    if (p.error <= most && (!best || std::pair(p.ms, p.error) < std::pair(best->ms, best->error))) best = &p;
  if (!best) return nullptr;
  // A quality by its name is easier to ask for than one knob of it, where they are the same.
  for (const ErrorPoint& p : points)
    if (!best->row->settings.empty() && p.row->settings.empty() && p.error <= best->error && p.ms < best->ms + doubt_ms(*p.row, *best->row)) best = &p;
  return best->row;
}

const BenchRow* most_exact(std::span<const BenchRow* const> rows, const std::string& reference, const std::string& metric, double ms) {
  const ErrorPoint* best = nullptr;
  const auto points = error_points(rows, reference, metric);
  for (const ErrorPoint& p : points)
    if (p.ms <= ms && (!best || std::pair(p.error, p.ms) < std::pair(best->error, best->ms))) best = &p;
  return best ? best->row : nullptr;
}

std::string cheapest_sentence(std::span<const BenchRow* const> rows, const std::string& reference, const std::string& metric, double most) {
  const BenchRow* row = cheapest(rows, reference, metric, most);
  if (!row) return fmt::format("no setting has {} below {} against {}", metric, most, reference);
  const double error = *error_of(*row, reference, metric);
  std::string text = fmt::format("for {} below {} against {} the cheapest setting is {}: {:.3g} ms on the GPU, {} {:.3g}", metric, most,
                                 reference, error_setting(*row), median_ms(*row), metric, error);
  if (const auto& noise = error_against(*row, reference)->noise; noise && metric == "relmse" && error <= noise->relmse)
    text += fmt::format(", which is below the reference's own noise of {:.3g}", noise->relmse);
  return text;
}

std::vector<KnobStudy> knob_studies(std::span<const BenchRow* const> rows) {
  std::vector<KnobStudy> studies;
  std::optional<double> whole;  // of the technique at its best, against what it approximates
  for (const BenchRow* row : rows)
    if (row->suite == "whole" && row->quality == "exact")
      if (const auto error = error_of(*row, open_reference_name, "relmse"); error && !whole) whole = error;
  for (const BenchRow* row : rows) {
    if (!row->suite.starts_with("knob ")) continue;
    const std::string knob = row->suite.substr(5);
    const auto relmse = error_of(*row, exact_reference, "relmse"), rmse = error_of(*row, exact_reference, "rmse");
    if (!relmse || !rmse) continue;
    auto found = std::find_if(studies.begin(), studies.end(), [&](const KnobStudy& s) { return s.knob == knob; });
    KnobStudy& study = found == studies.end() ? studies.emplace_back(KnobStudy{.knob = knob}) : *found;
    KnobStudy::Value value{.row = row, .text = setting_value(*row, knob), .relmse = *relmse, .rmse = *rmse};
    std::from_chars(value.text.data(), value.text.data() + value.text.size(), value.value);
    value.ms = median_ms(*row), value.mad_ms = summary(row->gpu.ms).mad;
    study.values.push_back(std::move(value));
  }
  for (KnobStudy& study : studies) {
    fit_order(study);
    judge_values(study, whole);
  }
  return studies;
}

}  // namespace candela
