#include <algorithm>

#include "job/frame_choices.h"
#include "passes/post/tonemap.h"
#include "passes/shared/light_knobs.h"
#include "passes/shared/pass_list.h"
#include "techniques/technique.h"

// What a job may choose from: techniques, methods, layers, effects, by their names.
namespace candela {

bool has_own_pixels(const std::string& technique) {
  return std::ranges::any_of(techniques(), [&](const Technique& t) { return t.name == technique && t.own_pixels(); });
}

Job with_every_light(Job job, const std::string& reference) {
  if (!has_own_pixels(job.technique)) {
    job.technique = reference;
  } else {
    const std::span<const Knob> table = LightKnobs::table();
    const auto few = std::ranges::find(table, "few", &Knob::name);
    job.settings.push_back({std::string(LightKnobs::name), "few", few->text(few->highest)});
  }
  return job;
}

ChosenTechnique quickest_technique(bool is_cpu, bool int64_atomics) {
  if (is_cpu) return {"clustered", "the device is a CPU, where the driver rasterizes faster than shaders would"};
  if (!int64_atomics) return {"clustered", "the device has no 64-bit atomics, which visibility needs"};
  return {"visibility", "the device is a GPU, which shades in compute many times as fast"};
}

std::vector<std::string> technique_names() {
  std::vector<std::string> names;
  for (const Technique& t : techniques()) names.emplace_back(t.name);
  return names;
}
std::vector<std::string> transparency_names() {
  std::vector<std::string> names;
  for (const TransparencyMethod& m : transparency_methods()) names.emplace_back(m.name);
  return names;
}
std::vector<std::string> layer_names() {
  std::vector<std::string> names;
  for (const PassInfo& pass : pass_list())
    for (const LayerName& layer : pass.layers) names.emplace_back(layer.name);
  return names;
}
std::vector<std::string> effect_names() {
  std::vector<std::string> names;
  const auto add = [&](std::string_view effect) {
    if (!effect.empty() && std::ranges::find(names, effect) == names.end()) names.emplace_back(effect);
  };
  for (const PassInfo& pass : pass_list()) {
    add(pass.effect);
    for (const std::string_view effect : pass.shading_effects) add(effect);
  }
  return names;
}
std::vector<std::string> view_names() {
  std::vector<std::string> names = layer_names();
  names.insert(names.begin(), "beauty");
  return names;
}
std::string_view technique_description(std::string_view name) {
  for (const Technique& t : techniques())
    if (t.name == name) return t.description;
  return {};
}
std::string_view transparency_description(std::string_view name) {
  for (const TransparencyMethod& m : transparency_methods())
    if (m.name == name) return m.description;
  return {};
}
std::string_view layer_description(std::string_view name) {
  if (name == "beauty") return "the picture itself";
  for (const PassInfo& pass : pass_list())
    for (const LayerName& layer : pass.layers)
      if (layer.name == name) return layer.description;
  return {};
}
std::vector<std::string> tonemap_names() { return {tone_curve_names().begin(), tone_curve_names().end()}; }

}  // namespace candela
