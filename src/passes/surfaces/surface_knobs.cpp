#include "passes/surfaces/surface_knobs.h"

namespace candela {

std::span<const Knob> SurfaceKnobs::table() {
  static const Knob rows[] = {
      {.name = "specular_aa",
       .member = &SurfaceKnobs::specular_aa,
       .lowest = 0,
       .highest = 2,
       .levels = {},
       .description =
           "highlights of normals that turn within a pixel are made as much wider: of the shading normal's "
           "differences between pixels (normals), or of the mesh's and by what a filtered normal map has lost "
           "(maps); off: they sparkle and shift, and more samples a pixel (supersample.n) are the exact end",
       .choices = {"off", "normals", "maps"},
       .sweep = {1, 2, 0}},
  };
  return rows;
}

bool SurfaceKnobs::matter(const SceneFacts& facts) { return facts.takes_light(); }

}  // namespace candela
