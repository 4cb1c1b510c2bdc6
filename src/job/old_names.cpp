#include "job/old_names.h"

#include <fmt/ranges.h>

#include <span>

#include "base/log.h"
#include "base/text.h"

namespace candela {
namespace {

struct OldName {
  std::string_view before, now;
};
constexpr OldName layers[] = {{"shadow", "shadow_sun"},
                              {"shadow.lamps", "shadow_local"},
                              {"direct.sun", "direct_sun"},
                              {"direct.point", "direct_point"},
                              {"direct.spot", "direct_spot"},
                              {"ambient.diffuse", "ambient_diffuse"},
                              {"ambient.specular", "ambient_specular"},
                              {"fog.transmittance", "fog_transmittance"},
                              {"heatmap.lights", "heatmap_lights"},
                              {"heatmap.waste", "heatmap_waste"},
                              {"heatmap.missed", "heatmap_missed"},
                              {"heatmap.traversal", "heatmap_traversal"},
                              {"heatmap.leaves", "heatmap_leaves"},
                              {"debug.cascades", "debug_cascades"},
                              {"debug.light_volumes", "debug_light_volumes"},
                              {"debug.bvh", "debug_bvh"}};
constexpr OldName effects[] = {{"ssr", "reflections"}};
constexpr OldName tables[] = {{"shadows", "local"}};
constexpr OldName knobs[] = {{"fog.lamp_shadows", "fog.local_shadows"}};

void take_new(std::string& name, std::span<const OldName> names, std::string_view what) {
  for (const OldName& old : names)
    if (name == old.before) {
      log::info("{} {} is now called {}", what, old.before, old.now);
      name = old.now;
      return;
    }
}

}  // namespace

void take_new_names(KnobSetting& setting) {
  take_new(setting.pass, tables, "the table of knobs");
  std::string knob = setting.pass + "." + setting.knob;
  take_new(knob, knobs, "the knob");
  setting.knob = knob.substr(setting.pass.size() + 1);
}

void take_new_names(Job& job) {
  for (std::string& layer : job.layers) take_new(layer, layers, "the layer");
  take_new(job.view, layers, "the layer");
  std::vector<std::string> names = split(job.effects, ',');
  for (std::string& name : names) take_new(name, effects, "the effect");
  job.effects = fmt::format("{}", fmt::join(names, ","));
}

}  // namespace candela
