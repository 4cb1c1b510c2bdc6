#include "bench/error_analysis.h"

#include <charconv>
#include <set>

#include "base/text.h"
#include "bench/error_truth.h"
#include "bench/error_views.h"
#include "plan/plan_frame.h"

namespace candela {
namespace {

double median_ms(const BenchRow& row) { return summary(row.gpu.ms).median; }

// How well a fit explains the logarithms: the fraction of their variance.
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

ComparedRows compared_values(const KnobStudy& study) {
  std::vector<const BenchRow*> rows;
  for (const KnobStudy::Value& v : study.values) rows.push_back(v.row);
  return ComparedRows(rows);
}

void find_dominated(KnobStudy& study, ComparedRows& compared) {
  for (KnobStudy::Value& v : study.values)
    for (const KnobStudy::Value& other : study.values)
      if (!v.dominated && compared.quicker(*other.row, *v.row) &&
          compared.no_worse(*other.row, *v.row, exact_reference, "relmse")) {
        v.dominated = true;
        v.verdict = "no: " + other.text + " is quicker and no worse";
      }
}

// Of values that all give the same picture: the one that presets take, unless another is surely quicker.
void judge_times(KnobStudy& study) {
  ComparedRows compared = compared_values(study);
  find_dominated(study, compared);
  const KnobStudy::Value* best = &study.values.back();
  for (KnobStudy::Value& v : study.values) {
    if (!v.dominated) v.verdict = "not distinguishable: no other is surely quicker";
    if (compared.quicker(*v.row, *best->row)) best = &v;
  }
  study.advised = best->text;
}

// A tenth of what is wrong anyway is not seen: the cheapest value whose own error stays below it is the one worth its
// time; among values whose times are not distinguishable, the one with less error.
void judge_values(KnobStudy& study, std::optional<double> model_relmse) {
  const auto& values = study.values;
  if (study.kind == "time") return judge_times(study);
  if (std::all_of(values.begin(), values.end(), [](const KnobStudy::Value& v) { return v.rmse == 0; })) {
    for (KnobStudy::Value& v : study.values) v.verdict = "changes nothing in this picture";
    return;
  }
  ComparedRows compared = compared_values(study);
  find_dominated(study, compared);
  const KnobStudy::Value* best = nullptr;
  for (KnobStudy::Value& v : study.values) {
    const bool hidden = model_relmse ? v.relmse <= 0.1 * *model_relmse : v.relmse == 0;
    if (!v.dominated) v.verdict = hidden ? "its error is hidden under the technique's own" : "its error shows";
    if (!hidden) continue;
    if (!best || compared.quicker(*v.row, *best->row) ||
        (!compared.quicker(*best->row, *v.row) && v.relmse < best->relmse))
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
  place += row_look(row);
  if (row.time_s != 0) place += fmt::format(", at {} s", row.time_s);
  if (row.views > 1) place += fmt::format(", {} views", row.views);
  return place + ", " + row.device;
}

std::string error_setting(const BenchRow& row) {
  return fmt::format("{}, quality {}{}{}", row.technique, row.quality, row.settings.empty() ? "" : ", ", row.settings);
}

std::string error_names(const BenchRow& row) {
  std::string names = error_setting(row);
  for (const SameWork& same : row.same_work)
    names += fmt::format(" = {}, quality {}{}{}", same.technique, same.quality, same.settings.empty() ? "" : ", ",
                         same.settings);
  return names;
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

std::string truth_of(const BenchRow& row) {
  if (!row.truth.empty()) return row.truth;
  const bool shadowed = row.effects != "none" && error_against(row, "direct");
  return shadowed ? "direct" : open_reference_name;
}

std::string truth_of(std::span<const BenchRow* const> rows) {
  for (const BenchRow* row : rows)
    if (!row->gpu.ms.empty()) return truth_of(*row);
  return rows.empty() ? open_reference_name : truth_of(*rows.front());
}

std::vector<ErrorPoint> error_points(std::span<const BenchRow* const> rows, const std::string& reference,
                                     const std::string& metric) {
  using Standing = ErrorPoint::Standing;
  std::vector<ErrorPoint> points;
  const TimeNoise noise = time_noise(rows);
  for (const BenchRow* row : rows)
    if (const auto error = error_of(*row, reference, metric))
      points.push_back({row, median_ms(*row), *error, time_interval(row->gpu.ms, noise),
                        error_interval(*error_against(*row, reference), metric)});
  ComparedRows compared(rows);
  for (ErrorPoint& p : points)
    for (const ErrorPoint& q : points) {
      if (&p == &q || p.standing == Standing::dominated) continue;
      const bool sure = compared.quicker(*q.row, *p.row) && compared.no_worse(*q.row, *p.row, reference, metric);
      const bool seems = q.ms <= p.ms && q.error <= p.error && (q.ms < p.ms || q.error < p.error);
      if (sure || (seems && p.standing == Standing::front))
        p.standing = sure ? Standing::dominated : Standing::unclear, p.by = q.row;
    }
  return points;
}

const char* standing_name(ErrorPoint::Standing standing) {
  static constexpr const char* names[] = {"front", "not distinguishable", "dominated"};
  return names[int(standing)];
}

std::vector<SettingPoint> setting_points(std::span<const BenchRow* const> rows, const std::string& reference,
                                         const std::string& metric) {
  struct Gathered {
    SettingPoint point;
    std::set<std::string> places;
  };
  std::vector<std::pair<std::string, Gathered>> settings;  // in the order of the rows
  std::set<std::string> places;
  const TimeNoise noise = time_noise(rows);
  for (const BenchRow* row : rows) {
    const auto error = error_of(*row, reference, metric);
    if (!error) continue;
    places.insert(error_place(*row));
    const std::string name = error_setting(*row);
    auto found = std::find_if(settings.begin(), settings.end(), [&](const auto& s) { return s.first == name; });
    if (found == settings.end()) found = settings.insert(settings.end(), {name, {}});
    auto& [point, seen] = found->second;
    seen.insert(error_place(*row));
    const double ms = median_ms(*row);
    const Interval ms_ci = time_interval(row->gpu.ms, noise);
    const Interval error_ci = error_interval(*error_against(*row, reference), metric);
    if (!point.row || ms > point.ms) point.row = row;
    point.ms = std::max(point.ms, ms), point.error = std::max(point.error, *error);
    point.ms_ci = {std::max(point.ms_ci.low, ms_ci.low), std::max(point.ms_ci.high, ms_ci.high)};
    point.error_ci = {std::max(point.error_ci.low, error_ci.low), std::max(point.error_ci.high, error_ci.high)};
  }
  std::vector<SettingPoint> points;
  for (const auto& [name, gathered] : settings)
    if (gathered.places.size() == places.size()) points.push_back(gathered.point);
  return points;
}

const SettingPoint* cheapest(std::span<const SettingPoint> settings, double most) {
  const SettingPoint* best = nullptr;
  const auto cheaper = [](const SettingPoint& a, const SettingPoint* b) {
    return !b || std::pair(a.ms, a.error) < std::pair(b->ms, b->error);
  };
  for (const SettingPoint& s : settings)
    if (s.error_ci.high <= most && cheaper(s, best)) best = &s;
  if (!best || best->row->settings.empty()) return best;
  // A quality by its name is easier to ask for than one knob of it, where they are the same.
  const SettingPoint* named = nullptr;
  for (const SettingPoint& s : settings)
    if (s.row->settings.empty() && s.error <= best->error && s.error_ci.high <= most &&
        order_of_times(*best->row, *s.row).order != Order::less && cheaper(s, named))
      named = &s;
  return named ? named : best;
}

const SettingPoint* most_exact(std::span<const SettingPoint> settings, double most_ms, const std::string& reference,
                               const std::string& metric) {
  const SettingPoint* best = nullptr;
  for (const SettingPoint& s : settings)
    if (s.ms_ci.high <= most_ms && (!best || std::pair(s.error, s.ms) < std::pair(best->error, best->ms))) best = &s;
  if (!best) return best;
  const SettingPoint* quickest = best;
  for (const SettingPoint& s : settings)
    if (s.ms_ci.high <= most_ms && s.ms < quickest->ms &&
        order_of_errors(*best->row, *s.row, reference, metric).order != Order::less)
      quickest = &s;
  return quickest;
}

std::string bounded_text(double value, double bound) {
  for (int digits = 3; digits < 9; ++digits) {
    std::string text = fmt::format("{:.{}g}", value, digits);
    if ((std::strtod(text.c_str(), nullptr) <= bound) == (value <= bound)) return text;
  }
  return fmt::format("{}", value);
}

namespace {

// Empty where three digits show no interval.
std::string interval_text(const char* format, double value, const Interval& ci) {
  const std::string low = fmt::format("{:.3g}", ci.low), high = fmt::format("{:.3g}", ci.high);
  const std::string middle = fmt::format("{:.3g}", value);
  return low == middle && high == middle ? "" : fmt::format(fmt::runtime(format), low, high);
}

}  // namespace

std::string cheapest_sentence(std::span<const BenchRow* const> rows, const std::string& reference,
                              const std::string& metric, double most) {
  const std::vector<SettingPoint> settings = setting_points(rows, reference, metric);
  if (settings.empty()) return {};
  const SettingPoint* s = cheapest(settings, most);
  if (!s) {
    const auto least = std::min_element(settings.begin(), settings.end(),
                                        [](const auto& a, const auto& b) { return a.error_ci.high < b.error_ci.high; });
    return fmt::format("no setting surely has {} below {} against {}: {} has {}{}", metric, most, reference,
                       error_setting(*least->row), bounded_text(least->error, most),
                       interval_text(" (95 % CI {} to {})", least->error, least->error_ci));
  }
  std::string text =
      fmt::format("for {} below {} against {} the cheapest setting is {}: {:.3g} ms{}, {} {}{}", metric, most,
                  reference, error_setting(*s->row), s->ms, interval_text(" (95 % CI {} to {})", s->ms, s->ms_ci),
                  metric, bounded_text(s->error, most), interval_text(" ({} to {})", s->error, s->error_ci));
  const auto& noise = error_against(*s->row, reference)->noise;
  if (noise && metric == "relmse" && s->error <= noise->relmse)
    text += fmt::format(", which is below the reference's own noise of {:.3g}", noise->relmse);
  return text;
}

std::vector<std::string> cheapest_sentences(std::span<const BenchRow* const> rows, std::span<const double> bounds) {
  const std::string truth = truth_of(rows);
  const std::vector<SettingPoint> settings = setting_points(rows, truth, "relmse");
  std::vector<std::string> sentences;
  const BenchRow* told = nullptr;
  for (const double bound : bounds) {
    const SettingPoint* s = cheapest(settings, bound);
    std::string sentence = cheapest_sentence(rows, truth, "relmse", bound);
    if (sentence.empty()) return sentences;
    if (s && s->row == told) sentences.pop_back();
    sentences.push_back(std::move(sentence));
    if (!s) return sentences;
    told = s->row;
  }
  return sentences;
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
  const TimeNoise noise = time_noise(rows);
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
    value.ms = median_ms(row), value.ms_ci = time_interval(row.gpu.ms, noise);
    value.relmse_ci = error_interval(*error_against(row, exact_reference), "relmse");
    const std::vector<double> passes = passes_ms(row, point.passes);
    value.passes_ms = median(passes), value.passes_ci = time_interval(passes, noise);
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
    if (exact) model = error_of(*exact, truth_of(*exact), "relmse-trimmed");
    if (exact && !model) model = error_of(*exact, truth_of(*exact), "relmse");
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

std::vector<BenchRow> rows_by_name(std::span<const BenchRow* const> rows) {
  std::vector<BenchRow> named;
  for (const BenchRow* row : rows) {
    named.push_back(*row);
    for (const SameWork& same : row->same_work) {
      BenchRow& other = named.emplace_back(*row);
      other.suite = same.suite, other.technique = same.technique, other.quality = same.quality;
      other.settings = same.settings, other.job = same.job, other.knobs = same.knobs;
      other.same_work.clear();
      if (same.exact)
        for (PictureError& error : other.errors)
          if (error.reference == exact_reference) error = *same.exact;
    }
  }
  return named;
}

std::vector<std::string> unswept_knobs(const std::vector<BenchRow>& rows) {
  std::set<std::string> swept, passes;
  for (const BenchRow& row : rows) {
    for (const KnobPoint& point : row.knobs) swept.insert(point.knob);
    for (const SameWork& same : row.same_work)
      for (const KnobPoint& point : same.knobs) swept.insert(point.knob);
    for (const Series& pass : row.passes) passes.insert(pass.name);
  }
  std::vector<std::string> names;
  for (const KnobRow& knob : knob_rows("exact")) {
    const std::string name = knob.pass + "." + knob.knob;
    if (swept.contains(name)) continue;
    const bool kept =
        std::any_of(knob.passes.begin(), knob.passes.end(), [&](const auto& pass) { return passes.contains(pass); });
    names.push_back(name + (knob.kind == "look"      ? " (of the look)"
                            : knob.sweep.size() <= 1 ? " (it has no values to sweep)"
                            : !kept                  ? " (no row has its passes)"
                                                     : " (its passes run; no row differs in it)"));
  }
  return names;
}

}  // namespace candela
