#include "testscenes/light_arrays.h"

namespace candela {

void LightArrays::add(glm::dvec3 at, glm::dvec3 tint, double candela, double range_m, glm::dvec3 change) {
  push(translation, at);
  push(color, tint);
  intensity.push_back(candela);
  range.push_back(range_m);
  push(modulation, change);
}

void LightArrays::aim(glm::dvec3 to) { push(direction, to); }

json LightArrays::extension(GlbWriter& out, int light) const {
  out.use_extension("CANDELA_light_instances");
  json attributes = {{"TRANSLATION", out.float_accessor(translation, 3)}};
  const auto attribute = [&](const char* name, const std::vector<double>& values, int components) {
    if (!values.empty()) attributes[name] = out.float_accessor(values, components);
  };
  attribute("DIRECTION", direction, 3);
  attribute("COLOR", color, 3);
  attribute("INTENSITY", intensity, 1);
  attribute("RANGE", range, 1);
  attribute("MODULATION", modulation, 3);
  return {{"CANDELA_light_instances", {{"light", light}, {"attributes", attributes}}}};
}

void LightArrays::write(GlbWriter& out, std::string_view name, int light) const {
  if (!translation.empty()) out.node(name, {{"extensions", extension(out, light)}});
}

}  // namespace candela
