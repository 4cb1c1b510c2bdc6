#include "passes/surfaces/relief_knobs.h"

namespace candela {

std::span<const Knob> ReliefKnobs::table() {
  static const Knob rows[] = {
      {.name = "steps",
       .member = &ReliefKnobs::steps,
       .lowest = 0,
       .highest = 1024,
       .levels = {32, 0, 0, 0},
       .description =
           "even steps in depth by which a ray looks for the relief below it; what is narrower than a step may be "
           "missed, at grazing angles the most. 0: texel by texel, exactly",
       .sweep = {8, 32, 128, 0}},
      {.name = "refinements",
       .member = &ReliefKnobs::refinements,
       .lowest = 0,
       .highest = 24,
       .levels = {4, 6, 8, 8},
       .description = "halvings of the step in which the ray met the relief: the depth is off by at most 1 / (steps * "
                      "2^refinements) of the layer's",
       .sweep = {2, 4, 8}},
      {.name = "light_steps",
       .member = &ReliefKnobs::light_steps,
       .lowest = -1,
       .highest = 1024,
       .levels = {16, 0, 0, 0},
       .description = "even steps from a point of a relief up to its plane, towards each light with a shadow map, in "
                      "which the relief's own shadow is looked for: in joints narrower than the map's texels, and at "
                      "the ends of walls. 0: texel by texel, exactly; -1: by the map alone",
       .sweep = {-1, 4, 16, 0}},
      {.name = "by_sample",
       .member = &ReliefKnobs::by_sample,
       .lowest = 0,
       .highest = 1,
       .levels = {0, 0, 0, 1},
       .description =
           "1: each sample of a multisampled pixel meets a relief for itself and is shaded for itself there; 0: the "
           "pixel has one depth and one outline of it. Exact: supersample.n",
       .sweep = {0, 1}},
  };
  return rows;
}

bool ReliefKnobs::matter(const SceneFacts& facts) { return facts.any_relief; }

}  // namespace candela
