#include "job/frame_knobs.h"

#include <fmt/ranges.h>

#include <charconv>
#include <cmath>

#include "base/text.h"
#include "job/frame_choices.h"
#include "techniques/technique.h"

namespace candela {
namespace {

// draft takes the first rung of every ladder, exact the last; ladders of four and more have a rung for normal and one
// for high, shorter ones give high the last. A knob without a ladder keeps its default.
double rung(const std::vector<double>& ladder, double by_default, const std::string& quality) {
  if (ladder.empty()) return by_default;
  if (quality == "draft") return ladder.front();
  if (quality == "normal" && ladder.size() > 2) return ladder[(ladder.size() - 1) / 2];
  if (quality == "high" && ladder.size() > 3) return ladder[ladder.size() - 2];
  return ladder.back();
}

Expected<double> parse_choice(const KnobSetting& s, const std::vector<std::string_view>& choices) {
  std::string names;
  for (size_t i = 0; i < choices.size(); ++i) {
    if (s.value == choices[i]) return double(i);
    names += (names.empty() ? "" : ", ") + std::string(choices[i]);
  }
  return fail(ErrorKind::usage, "--set", "{}.{}: '{}' is none of {}", s.pass, s.knob, s.value, names);
}

template <class K>
Expected<double> parse_value(const KnobSetting& s, const Knob<K>& knob) {
  if (!knob.choices.empty()) return parse_choice(s, knob.choices);
  std::string names;
  for (const auto& [named, name] : knob.named) {
    if (s.value == name) return named;
    names += std::string(name) + ", ";
  }
  double value = 0;
  const char* const end = s.value.data() + s.value.size();
  const auto [at, error] = std::from_chars(s.value.data(), end, value);
  const bool number = error == std::errc() && at == end;
  if (!knob.only.empty() && (!number || std::find(knob.only.begin(), knob.only.end(), value) == knob.only.end()))
    return fail(ErrorKind::usage, "--set", "{}.{}: '{}' is not {} or {}", s.pass, s.knob, s.value,
                fmt::join(std::span(knob.only).first(knob.only.size() - 1), ", "), knob.only.back());
  if (!number || !(value >= knob.lowest && value <= knob.highest))
    return fail(ErrorKind::usage, "--set", "{}.{}: '{}' is not {}a number from {} to {}", s.pass, s.knob, s.value,
                names.empty() ? "" : names + "or ", knob.lowest, knob.highest);
  if (std::holds_alternative<int K::*>(knob.member) && value != std::floor(value))
    return fail(ErrorKind::usage, "--set", "{}.{}: '{}' is not a whole number", s.pass, s.knob, s.value);
  return value;
}

template <class K>
std::string range_text(const Knob<K>& knob) {
  if (!knob.choices.empty()) return fmt::format("{}", fmt::join(knob.choices, "|"));
  if (!knob.only.empty()) return fmt::format("{}", fmt::join(knob.only, "|"));
  std::string text;
  for (const auto& [value, name] : knob.named) text += std::string(name) + "|";
  return text + fmt::format("{}..{}", knob.lowest, knob.highest);
}

}  // namespace

Expected<KnobValues> frame_knobs(const Job& job) {
  KnobValues all;
  all.each([&](std::string_view, const auto& knob, auto& knobs) {
    knob.set(knobs, rung(knob.ladder, knob.value(knobs), job.quality));
  });
  if (job.samples != 0) all.get<Resolve::Knobs>().samples = job.samples;
  std::vector<KnobSetting> settings;
  for (const Technique& t : techniques())
    if (t.name == job.technique)
      for (const Preset& p : t.presets)
        settings.push_back({std::string(p.table), std::string(p.knob), std::string(p.value)});
  settings.insert(settings.end(), job.settings.begin(), job.settings.end());
  for (const KnobSetting& s : settings) {
    bool known = false;
    Expected<void> outcome;
    all.each([&](std::string_view table, const auto& knob, auto& knobs) {
      if (table != s.pass || knob.name != s.knob) return;
      known = true;
      if (const auto value = parse_value(s, knob))
        knob.set(knobs, *value);
      else
        outcome = std::unexpected(value.error());
    });
    if (!outcome) return std::unexpected(outcome.error());
    if (!known)
      return fail(ErrorKind::usage, "--set", "there is no knob {}.{} (candela list knobs shows all)", s.pass, s.knob);
  }
  if (const int samples = all.get<Resolve::Knobs>().samples; job.samples != 0 && samples != job.samples)
    return fail(ErrorKind::usage, "--set", "resolve.samples={} contradicts --samples {}", samples, job.samples);
  return all;
}

std::vector<KnobRow> knob_rows(const std::string& quality) {
  KnobValues all;
  std::vector<KnobRow> rows;
  all.each([&]<class K>(std::string_view table, const Knob<K>& knob, K& knobs) {
    knob.set(knobs, rung(knob.ladder, knob.value(knobs), quality));
    std::vector<std::string> ladder;
    for (const double v : knob.ladder) ladder.push_back(knob.text(v));
    KnobRow row{.pass = std::string(table),
                .knob = std::string(knob.name),
                .value_now = knob.text(knob.value(knobs)),
                .unit = std::string(knob.unit),
                .range = range_text(knob),
                .ladder = joined(ladder, " "),
                .trades = std::string(knob.trades),
                .kind = knob.kind == Trades::error  ? "error"
                        : knob.kind == Trades::time ? "time"
                                                    : "look"};
    for (const double v : knob.walk.empty() ? knob.ladder : knob.walk) row.walk.push_back(knob.text(v));
    row.passes = passes_of_table<K>();
    if (!knob.beside.empty()) row.beside = split(std::string(knob.beside), ' ');
    rows.push_back(std::move(row));
  });
  return rows;
}

std::vector<std::string> pass_names() {
  std::vector<std::string> names;
  AllPasses::each([&]<class P>(std::type_identity<P>) { names.emplace_back(P::name); });
  return names;
}

}  // namespace candela
