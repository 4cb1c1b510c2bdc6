#include "passes/surfaces/surface_knobs.h"

namespace candela {

std::span<const Knob> SurfaceKnobs::table() {
  static const Knob rows[] = {
      {.name = "specular_aa",
       .member = &SurfaceKnobs::specular_aa,
       .lowest = 0,
       .highest = 2,
       .levels = {},
       .description = "widens highlights where normals vary within a pixel, by the differences of the shading normal "
                      "between pixels (normals), or of the mesh's normal and what filtering took from the normal map "
                      "(maps); off: such highlights sparkle and shift. Exact end: more samples a pixel (supersample.n)",
       .choices = {"off", "normals", "maps"},
       .sweep = {1, 2, 0}},
  };
  return rows;
}

bool SurfaceKnobs::matter(const SceneFacts& facts) { return facts.takes_light(); }

}  // namespace candela
