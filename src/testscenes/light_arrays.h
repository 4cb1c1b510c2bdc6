#pragma once
#include <vector>

#include "testscenes/glb_writer.h"

namespace candela {

// The attributes of one node with CANDELA_light_instances, as they are gathered.
struct LightArrays {
  std::vector<double> translation, direction, color, intensity, range, modulation;

  // modulation: depth, period in seconds, phase.
  void add(glm::dvec3 at, glm::dvec3 color, double candela, double range_m, glm::dvec3 modulation);
  void aim(glm::dvec3 direction);  // of the last one; of all or of none
  // A node of the scene, where there are any lights.
  void write(GlbWriter& out, std::string_view name, int light) const;
  json extension(GlbWriter& out, int light) const;
};

}  // namespace candela
