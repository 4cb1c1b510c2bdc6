#include "frame/frame_knobs.h"

#include <bit>
#include <charconv>

#include "base/text.h"
#include "frame/plan_frame.h"
#include "passes/debug/layers.h"
#include "passes/debug/light_heat.h"
#include "passes/geometry/cull.h"
#include "passes/geometry/cull_compact.h"
#include "passes/geometry/deform.h"
#include "passes/geometry/depth_prepass.h"
#include "passes/lights/light_assign.h"
#include "passes/lights/light_fill.h"
#include "passes/lights/light_scan.h"
#include "passes/lights/light_sort.h"
#include "passes/lights/tile_depth.h"
#include "passes/post/readback.h"
#include "passes/post/resolve.h"
#include "passes/post/tonemap.h"
#include "passes/sky/background.h"
#include "passes/sky/sky.h"
#include "passes/surfaces/shade_forward.h"
#include "passes/surfaces/shade_unlit.h"
#include "passes/surfaces/transparent.h"

namespace candela {
namespace {

// All knobs of all passes, each with its value.
struct AllKnobs {
  Cull::Knobs cull;
  Resolve::Knobs resolve;
  LightKnobs lights;
};

template <class F>
void for_each_knob(AllKnobs& all, F&& f) {
  for (const auto& knob : Cull::knob_table()) f(Cull::name, knob, all.cull);
  for (const auto& knob : Resolve::knob_table()) f(Resolve::name, knob, all.resolve);
  for (const auto& knob : LightKnobs::knob_table()) f(LightKnobs::name, knob, all.lights);
}

template <class K>
double get(const Knob<K>& knob, const K& knobs) {
  return std::visit([&](auto member) { return double(knobs.*member); }, knob.member);
}
template <class K>
void set(const Knob<K>& knob, K& knobs, double value) {
  std::visit([&](auto member) { knobs.*member = std::remove_reference_t<decltype(knobs.*member)>(value); },
             knob.member);
}

// draft takes the first rung of every ladder, exact the last; ladders of four and more have a rung for normal and one
// for high, shorter ones give high the last.
double rung(const std::vector<double>& ladder, const std::string& quality) {
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

Expected<double> parse_value(const KnobSetting& s, double lowest, double highest) {
  double value = 0;
  const char* const end = s.value.data() + s.value.size();
  const auto [at, error] = std::from_chars(s.value.data(), end, value);
  if (error != std::errc() || at != end || !(value >= lowest && value <= highest))
    return fail(ErrorKind::usage, "--set", "{}.{}: '{}' is not a number from {} to {}", s.pass, s.knob, s.value, lowest,
                highest);
  return value;
}

}  // namespace

Expected<FrameKnobValues> frame_knobs(const Job& job) {
  AllKnobs all;
  for_each_knob(
      all, [&](std::string_view, const auto& knob, auto& knobs) { set(knob, knobs, rung(knob.ladder, job.quality)); });
  if (job.samples != 0) all.resolve.samples = job.samples;
  for (const KnobSetting& s : job.settings) {
    bool known = false;
    Expected<void> outcome;
    for_each_knob(all, [&](std::string_view pass, const auto& knob, auto& knobs) {
      if (pass != s.pass || knob.name != s.knob) return;
      known = true;
      const auto value =
          knob.choices.empty() ? parse_value(s, knob.lowest, knob.highest) : parse_choice(s, knob.choices);
      if (value && pass == Resolve::name && knob.name == "samples" && job.samples != 0 && *value != job.samples)
        outcome = fail(ErrorKind::usage, "--set", "resolve.samples={} contradicts --samples {}", s.value, job.samples);
      else if (!value)
        outcome = std::unexpected(value.error());
      else
        set(knob, knobs, *value);
    });
    if (!outcome) return std::unexpected(outcome.error());
    if (!known)
      return fail(ErrorKind::usage, "--set", "there is no knob {}.{} (candela list knobs shows all)", s.pass, s.knob);
  }
  const int samples = all.resolve.samples;
  if (samples != 1 && samples != 2 && samples != 4 && samples != 8)
    return fail(ErrorKind::usage, "--set", "resolve.samples: {} is not 1, 2, 4 or 8", samples);
  if (const int n = all.lights.slices_per_octave; !std::has_single_bit(unsigned(n)))
    return fail(ErrorKind::usage, "--set", "lights.slices_per_octave: {} is not 1, 2, 4, 8 or 16", n);
  return FrameKnobValues{samples, all.cull.enabled != 0, all.lights};
}

std::vector<KnobRow> knob_rows(const std::string& quality) {
  AllKnobs all;
  std::vector<KnobRow> rows;
  for_each_knob(all, [&](std::string_view pass, const auto& knob, auto& knobs) {
    set(knob, knobs, rung(knob.ladder, quality));
    // A float says as many digits as tell it from its neighbours: 0.01, not 0.009999999776482582.
    const bool is_float = knob.member.index() == 1;
    const auto text = [&](double v) {
      if (!knob.choices.empty()) return std::string(knob.choices[size_t(v)]);
      return is_float ? fmt::format("{}", float(v)) : fmt::format("{}", v);
    };
    std::vector<std::string> ladder;
    for (const double v : knob.ladder) ladder.push_back(text(v));
    KnobRow row{.pass = std::string(pass),
                .knob = std::string(knob.name),
                .value_now = text(get(knob, knobs)),
                .unit = std::string(knob.unit),
                .range = knob.choices.empty()
                             ? fmt::format("{}..{}", knob.lowest, knob.highest)
                             : joined(std::vector<std::string>(knob.choices.begin(), knob.choices.end()), "|"),
                .ladder = joined(ladder, " "),
                .trades = std::string(knob.trades),
                .kind = knob.kind == Trades::error  ? "error"
                        : knob.kind == Trades::time ? "time"
                                                    : "look"};
    for (const double v : knob.walk.empty() ? knob.ladder : knob.walk) row.walk.push_back(text(v));
    for (const std::string_view p : knob.passes) row.passes.emplace_back(p);
    if (row.passes.empty()) row.passes.emplace_back(pass);
    rows.push_back(std::move(row));
  });
  return rows;
}

std::vector<std::string> pass_names() {
  std::vector<std::string> names;
  for (const std::string_view n : {Cull::name, CullCompact::name, Deform::name, DepthPrepass::name, TileDepth::name,
                                   LightAssign::name, LightScan::name, LightFill::name, LightSort::name,
                                   ShadeForward::name, ShadeUnlit::name, Sky::name, Background::name, Transparent::name,
                                   Layers::name, LightHeat::name, Resolve::name, Tonemap::name, Readback::name})
    names.emplace_back(n);
  return names;
}

}  // namespace candela
