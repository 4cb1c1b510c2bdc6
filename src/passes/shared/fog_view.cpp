#include "passes/shared/fog_view.h"

#include "passes/shared/draw_batches.h"

namespace candela {

bool fog_is_read(const Lighting& lists) {
  return lists.fog.light == FogLight::grid || lists.fog.light == FogLight::texels;
}

Lighting of_blended(Lighting lists) {
  if (lists.fog.light == FogLight::texels) lists.fog.light = FogLight::march, lists.fog.grid = {};
  return lists;
}

Lighting fog_on_the_way(Lighting lists) {
  if (lists.fog) lists.fog.light = FogLight::nothing, lists.fog.grid = {};
  return lists;
}

bool fog_walks(const Lighting& lists) {
  return lists.fog.light == FogLight::march || (lists.fog.light == FogLight::grid && lists.fog.last > 0);
}

std::string fog_shadows(const Lighting& lists, int lamp_points, int sun_points) {
  const bool sun = bool(lists.sun_maps), lamps = lists.lamp_maps && lamp_points > 0;
  std::string defined = sun ? fmt::format("#FOG_SUN={}", sun_points) : "";
  if (lamps) defined += fmt::format("#FOG_LAMP_SHADOWS={}", lamp_points);
  const int deep = (sun && lists.deep.suns ? 1 : 0) + (lamps && lists.deep.lamps ? 2 : 0);
  if (deep > 0) defined += fmt::format("#FOG_DEEP_SHADOWS={}", deep);
  return defined;
}

std::string with_fog(std::string shader, const Lighting& lists) {
  if (!lists.fog) return shader;
  shader += fmt::format("#FOG={}", int(lists.fog.light));
  if (lists.fog.media > 0) shader += fmt::format("#FOG_MEDIA={}", lists.fog.media);
  if (!fog_walks(lists)) return shader;
  if (lists.fog.light == FogLight::grid) shader += fmt::format("#FOG_LAST={}", lists.fog.last);
  if (lists.fog.ambient) shader += "#FOG_AMBIENT=1";
  return shader + fog_shadows(lists, lists.fog.lamp_points, lists.fog.sun_points);
}

void declare_fog(GraphBuilder& builder, const SceneInputs& scene, const Lighting& lists, bool lights_declared,
                 const ReadBy& by) {
  if (lists.fog.grid && fog_is_read(lists)) builder.read(lists.fog.grid, by.image, "the fog's light");
  if (fog_walks(lists) && !lights_declared) declare_lights(builder, scene, lists, by);
}

}  // namespace candela
