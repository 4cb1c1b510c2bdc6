#include "bench/suite.h"

#include <algorithm>

#include "base/text.h"
#include "job/frame_choices.h"
#include "job/old_names.h"
#include "scene/survey.h"
#include "techniques/technique.h"

namespace candela {
namespace {

using Settings = std::vector<KnobSetting>;

// All combinations of the sweeps' values, the last sweep changing fastest.
std::vector<Settings> combinations(const std::vector<KnobSweep>& sweeps) {
  std::vector<Settings> all = {{}};
  for (const KnobSweep& sweep : sweeps) {
    std::vector<Settings> longer;
    for (const Settings& before : all)
      for (const std::string& value : sweep.values) {
        longer.push_back(before);
        longer.back().push_back({sweep.pass, sweep.knob, value});
      }
    all = std::move(longer);
  }
  return all;
}

// The technique's own sweeps replace the suite's for the same knob.
std::vector<KnobSweep> sweeps_of(const Suite& suite, const SuiteTechnique& technique) {
  std::vector<KnobSweep> sweeps = technique.set;
  for (const KnobSweep& sweep : suite.set) {
    const bool own = std::any_of(technique.set.begin(), technique.set.end(),
                                 [&](const KnobSweep& s) { return s.pass == sweep.pass && s.knob == sweep.knob; });
    if (!own) sweeps.push_back(sweep);
  }
  return sweeps;
}

std::vector<SuiteTechnique> techniques_of(const Suite& suite) {
  if (!suite.techniques.empty()) return suite.techniques;
  std::vector<SuiteTechnique> all;
  for (const std::string& name : technique_names()) all.push_back({name, {}});
  return all;
}

std::vector<std::optional<int>> light_counts(const Suite& suite, const SuiteScene& scene) {
  if (!scene.generated()) return {std::nullopt};
  std::vector<std::optional<int>> counts;
  for (const int n : scene.lights.empty() ? suite.lights : scene.lights) counts.emplace_back(n);
  if (counts.empty()) counts.emplace_back();
  return counts;
}

Expected<void> check_suite(const Suite& suite) {
  if (suite.output != "exr" && suite.output != "png" && suite.output != "both")
    return fail(ErrorKind::usage, "output", "'{}' is none of exr, png and both", suite.output);
  const auto check_technique = [](const char* key, const std::string& name) -> Expected<void> {
    const auto names = technique_names();
    if (std::find(names.begin(), names.end(), name) != names.end()) return {};
    return fail(ErrorKind::usage, key, "{}", unknown_name("technique", name, names));
  };
  if (auto known = check_technique("reference", suite.reference); !known) return known;
  for (const SuiteTechnique& technique : suite.techniques)
    if (technique.name != auto_technique)
      if (auto known = check_technique("techniques", technique.name); !known) return known;
  for (const auto& [technique, most] : suite.max_lights)
    if (auto known = check_technique("max_lights", technique); !known) return known;
  for (const SuiteScene& scene : suite.scenes)
    if (!scene.generated() && !scene.lights.empty())
      return fail(ErrorKind::usage, scene.label, "only generated scenes take light counts");
  return {};
}

}  // namespace

Expected<KnobSweep> parse_knob_sweep(const std::string& text) {
  const auto setting = parse_knob_setting(text);
  if (!setting) return std::unexpected(setting.error());
  KnobSweep sweep{setting->pass, setting->knob, split(setting->value, ',')};
  for (const std::string& value : sweep.values)
    if (value.empty()) return fail(ErrorKind::usage, "", "'{}' holds an empty value", text);
  return sweep;
}

std::string settings_text(const Job& job) {
  std::vector<std::string> texts;
  for (const KnobSetting& s : job.settings) texts.push_back(s.pass + "." + s.knob + "=" + s.value);
  std::sort(texts.begin(), texts.end());
  return joined(texts, " ");
}

Expected<std::vector<Configuration>> configurations(const Suite& suite) {
  if (auto fine = check_suite(suite); !fine) return std::unexpected(fine.error());
  std::vector<Configuration> all;
  // From the slowest changing to the fastest; each step multiplies what there is.
  for (const SuiteScene& scene : suite.scenes)
    for (const std::optional<int>& lights : light_counts(suite, scene))
      all.push_back({.scene = scene, .lights = lights, .seed = scene.seed.value_or(suite.seed)});
  const auto multiply = [&](const auto& values, auto apply) {
    std::vector<Configuration> more;
    for (const Configuration& before : all)
      for (const auto& value : values) apply(more.emplace_back(before), value);
    all = std::move(more);
  };
  multiply(suite.sizes,
           [](Configuration& c, const std::pair<int, int>& size) { std::tie(c.job.width_px, c.job.height_px) = size; });
  multiply(suite.samples, [](Configuration& c, int samples) { c.job.samples = samples; });
  multiply(suite.qualities, [](Configuration& c, const std::string& quality) { c.job.quality = quality; });
  multiply(suite.effects, [](Configuration& c, const std::string& effects) {
    c.job.effects = effects;
    take_new_names(c.job);
  });
  multiply(suite.transparency, [](Configuration& c, const std::string& method) { c.job.transparency = method; });
  multiply(suite.times_s, [](Configuration& c, double time_s) { c.time_s = time_s; });
  std::vector<std::pair<std::string, Settings>> ways;
  for (const SuiteTechnique& technique : techniques_of(suite))
    for (Settings& settings : combinations(sweeps_of(suite, technique))) ways.emplace_back(technique.name, settings);
  multiply(ways, [](Configuration& c, const std::pair<std::string, Settings>& way) {
    c.job.technique = way.first;
    c.job.settings = way.second;
  });
  for (Configuration& c : all) {
    c.job.scene = c.scene.label;
    c.job.camera = c.scene.camera;
    c.job.sky = c.scene.sky.file, c.job.look = c.scene.look.file;
    c.job.exr_float = true;
    if (auto fine = check_job(c.job); !fine) return std::unexpected(fine.error());
    const auto limit = suite.max_lights.find(c.job.technique);
    if (!c.scene.missing.empty())
      c.left_out = c.scene.missing;
    else if (limit != suite.max_lights.end() && c.lights.value_or(0) > limit->second)
      c.left_out = fmt::format("the suite limits {} to {} lights", c.job.technique, limit->second);
  }
  return all;
}

Configuration reference_of(const Configuration& configuration, const std::string& technique) {
  Configuration reference = configuration;
  reference.left_out.clear();
  const std::vector<KnobRow> knobs = knob_rows(reference.job.quality);
  std::erase_if(reference.job.settings, [&](const KnobSetting& s) {
    return std::ranges::any_of(
        knobs, [&](const KnobRow& k) { return k.pass == s.pass && k.knob == s.knob && k.kind == "time"; });
  });
  reference.job = with_every_light(std::move(reference.job), technique);
  return reference;
}

std::string picture_group(const Configuration& configuration, const Suite& suite) {
  const Configuration c = reference_of(configuration, suite.reference);
  return fmt::format("{}\n{}\n{}\n{:a}\n{}\n{}", c.scene.label, c.seed, c.lights.value_or(-1), c.time_s,
                     job_json(c.job), settings_text(c.job));
}

}  // namespace candela
