#include "passes/volumes/fog_view.h"

#include "passes/geometry/draw_runs.h"

namespace candela {

bool fog_walks(const CellLists& lists) {
  return lists.fog.light == FogLight::march || (lists.fog.light == FogLight::grid && lists.fog.last);
}

std::string with_fog(std::string shader, const CellLists& lists) {
  if (!lists.fog) return shader;
  shader += fmt::format("#FOG={}", int(lists.fog.light));
  if (!fog_walks(lists)) return shader;
  if (lists.fog.light == FogLight::grid) shader += "#FOG_LAST=1";
  if (lists.fog.ambient) shader += "#FOG_AMBIENT=1";
  if (lists.sun_maps) shader += "#FOG_SUN=1";
  return shader;
}

void declare_fog(GraphBuilder& builder, const SceneInputs& scene, const CellLists& lists, bool lights_declared) {
  if (lists.fog.light == FogLight::grid) builder.read(lists.fog.grid, Access::sampled_fragment, "the fog's light");
  if (fog_walks(lists) && !lights_declared) declare_lights(builder, scene, lists);
}

}  // namespace candela
