#include <algorithm>

#include "job/frame_choices.h"
#include "passes/all_passes.h"
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
    const std::span<const Knob<LightKnobs>> table = LightKnobs::table();
    const auto few = std::ranges::find(table, "few", &Knob<LightKnobs>::name);
    job.settings.push_back({std::string(LightKnobs::name), "few", few->text(few->highest)});
  }
  return job;
}

ChosenTechnique quickest_technique(bool is_cpu, bool int64_atomics) {
  if (is_cpu) return {"clustered", "the device is a CPU, which rasterizes better than shaders on it do"};
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
  AllPasses::each([&]<class P>(std::type_identity<P>) {
    if constexpr (HasLayers<P>)
      for (const LayerName& layer : P::layers) names.emplace_back(layer.name);
  });
  return names;
}
std::vector<std::string> effect_names() {
  std::vector<std::string> names;
  AllPasses::each([&]<class P>(std::type_identity<P>) {
    if constexpr (IsEffect<P>)
      if (std::find(names.begin(), names.end(), P::effect) == names.end()) names.emplace_back(P::effect);
    if constexpr (ShadesEffect<P>)
      for (const std::string_view effect : P::shading_effects)
        if (std::find(names.begin(), names.end(), effect) == names.end()) names.emplace_back(effect);
  });
  return names;
}
std::vector<std::string> view_names() {
  std::vector<std::string> names = {"beauty"};
  AllPasses::each([&]<class P>(std::type_identity<P>) {
    if constexpr (HasLayers<P>)
      for (const LayerName& layer : P::layers) names.emplace_back(layer.name);
  });
  return names;
}
std::string_view technique_says(std::string_view name) {
  for (const Technique& t : techniques())
    if (t.name == name) return t.description;
  return {};
}
std::string_view transparency_says(std::string_view name) {
  for (const TransparencyMethod& m : transparency_methods())
    if (m.name == name) return m.description;
  return {};
}
std::string_view layer_says(std::string_view name) {
  std::string_view says;
  AllPasses::each([&]<class P>(std::type_identity<P>) {
    if constexpr (HasLayers<P>)
      for (const LayerName& layer : P::layers)
        if (layer.name == name) says = layer.says;
  });
  return name == "beauty" ? "the picture itself" : says;
}
std::vector<std::string> tonemap_names() { return {tone_curve_names().begin(), tone_curve_names().end()}; }

}  // namespace candela
