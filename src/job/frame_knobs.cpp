#include "job/frame_knobs.h"

#include <fmt/ranges.h>

#include <charconv>
#include <cmath>

#include "base/text.h"
#include "job/frame_choices.h"
#include "passes/post/resolve.h"
#include "passes/shared/pass_list.h"
#include "techniques/technique.h"

namespace candela {
namespace {

// draft takes the first level of every knob, exact the last; where there are four and more, one is of normal and one of
// high, else high takes the last. A knob without levels keeps its default.
double level(const std::vector<double>& levels, double by_default, const std::string& quality) {
  if (levels.empty()) return by_default;
  if (quality == "draft") return levels.front();
  if (quality == "normal" && levels.size() > 2) return levels[(levels.size() - 1) / 2];
  if (quality == "high" && levels.size() > 3) return levels[levels.size() - 2];
  return levels.back();
}

// The defaults, and what the quality makes of them.
KnobValues quality_knobs(const std::string& quality) {
  KnobValues all;
  for (const KnobTableInfo& table : knob_tables())
    for (const Knob& knob : table.rows) all.set(table, knob, level(knob.levels, all.value(table, knob), quality));
  return all;
}

// Null: there is none.
struct FoundKnob {
  const KnobTableInfo* table = nullptr;
  const Knob* knob = nullptr;
};
FoundKnob find_knob(const KnobSetting& setting) {
  for (const KnobTableInfo& table : knob_tables())
    if (table.name == setting.pass)
      for (const Knob& knob : table.rows)
        if (knob.name == setting.knob) return {&table, &knob};
  return {};
}

Expected<double> parse_choice(const KnobSetting& s, const std::vector<std::string_view>& choices) {
  std::string names;
  for (size_t i = 0; i < choices.size(); ++i) {
    if (s.value == choices[i]) return double(i);
    names += (names.empty() ? "" : ", ") + std::string(choices[i]);
  }
  return fail(ErrorKind::usage, "--set", "{}.{}: '{}' is none of {}", s.pass, s.knob, s.value, names);
}

Expected<double> parse_value(const KnobSetting& s, const Knob& knob) {
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
  if (!knob.member.is_float() && value != std::floor(value))
    return fail(ErrorKind::usage, "--set", "{}.{}: '{}' is not a whole number", s.pass, s.knob, s.value);
  return value;
}

std::string range_text(const Knob& knob) {
  if (!knob.choices.empty()) return fmt::format("{}", fmt::join(knob.choices, "|"));
  if (!knob.only.empty()) return fmt::format("{}", fmt::join(knob.only, "|"));
  std::string text;
  for (const auto& [value, name] : knob.named) text += std::string(name) + "|";
  return text + fmt::format("{}..{}", knob.lowest, knob.highest);
}

}  // namespace

Expected<KnobValues> frame_knobs(const Job& job) {
  KnobValues all = quality_knobs(job.quality);
  if (job.samples != 0) all.get<ResolveKnobs>().samples = job.samples;
  std::vector<KnobSetting> settings;
  for (const Technique& t : techniques())
    if (t.name == job.technique) settings = {t.presets.begin(), t.presets.end()};
  settings.insert(settings.end(), job.settings.begin(), job.settings.end());
  for (const KnobSetting& s : settings) {
    const auto [table, knob] = find_knob(s);
    if (!knob)
      return fail(ErrorKind::usage, "--set", "there is no knob {}.{} (candela list knobs shows all)", s.pass, s.knob);
    const auto value = parse_value(s, *knob);
    if (!value) return std::unexpected(value.error());
    all.set(*table, *knob, *value);
  }
  if (const int samples = all.get<ResolveKnobs>().samples; job.samples != 0 && samples != job.samples)
    return fail(ErrorKind::usage, "--set", "resolve.samples={} contradicts --samples {}", samples, job.samples);
  return all;
}

std::vector<KnobRow> knob_rows(const std::string& quality) {
  const KnobValues all = quality_knobs(quality);
  std::vector<KnobRow> rows;
  for (const KnobTableInfo& table : knob_tables())
    for (const Knob& knob : table.rows) {
      const auto text = [&](const std::vector<double>& values) {
        std::vector<std::string> texts;
        for (const double v : values) texts.push_back(knob.text(v));
        return texts;
      };
      KnobRow row{.pass = std::string(table.name),
                  .knob = std::string(knob.name),
                  .value_now = knob.text(all.value(table, knob)),
                  .unit = std::string(knob.unit),
                  .range = range_text(knob),
                  .levels = joined(text(knob.levels), " "),
                  .description = std::string(knob.description),
                  .kind = knob.kind == Trades::error  ? "error"
                          : knob.kind == Trades::time ? "time"
                                                      : "look",
                  .sweep = text(knob.sweep.empty() ? knob.levels : knob.sweep)};
      for (const PassInfo& pass : pass_list())
        if (std::ranges::find(pass.knob_tables, table.id) != pass.knob_tables.end()) row.passes.emplace_back(pass.name);
      if (!knob.required.empty()) row.required = split(std::string(knob.required), ' ');
      rows.push_back(std::move(row));
    }
  return rows;
}

std::vector<std::string> pass_names() {
  std::vector<std::string> names;
  for (const PassInfo& pass : pass_list()) names.emplace_back(pass.name);
  return names;
}

}  // namespace candela
