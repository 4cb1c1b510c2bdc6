#include "passes/shadows/lamp_knobs.h"

namespace candela {

bool LampKnobs::matter(const SceneFacts& facts) { return facts.point_lights + facts.spot_lights > 0; }

std::span<const Knob> LampKnobs::table() {
  constexpr std::string_view from_maps = "local.method=maps";
  static const Knob rows[] = {
      {.name = "method",
       .member = &LampKnobs::method,
       .lowest = 0,
       .highest = 2,
       .levels = {0, 0, 0, 2},
       .description =
           "shadows of point and spot lights: maps of as many as fit; or rays for all of them, from points of "
           "cells where these agree or from all points",
       .choices = {"maps", "voxels", "traced"},
       .sweep = {0, 1, 2}},
      {.name = "soft",
       .member = &LampKnobs::soft,
       .lowest = 0,
       .highest = 1,
       .levels = {0, 0, 0, 1},
       .description =
           "from maps, for lights with a size: hard shadows, or penumbras by what blocks nearby, which are not "
           "nearer to the truth everywhere",
       .choices = {"hard", "pcss"},
       .sweep = {0, 1},
       .required = from_maps},
      {.name = "samples",
       .member = &LampKnobs::samples,
       .lowest = 1,
       .highest = 65536,
       .levels = {4, 16, 16, 64},
       .description = "lookups or rays of a pixel to each light with a size; fewer leave noise",
       .sweep = {1, 4, 16, 64}},
      {.name = "lights",
       .member = &LampKnobs::lights,
       .lowest = 0,
       .highest = 4096,
       .levels = {8, 64, 256, 4096},
       .description =
           "point and spot lights that have shadows: those that the look marks first, then those that add most "
           "to the picture; a note names the rest. marked: no others",
       .sweep = {0, 16, 64, 4096},
       .required = from_maps,
       .named = {{0, "none"}, {-1, "marked"}}},
      {.name = "budget_mb",
       .member = &LampKnobs::budget_mb,
       .unit = "MB",
       .lowest = 1,
       .highest = 16384,
       .levels = {32, 64, 128, 1024},
       .description = "memory of the shadow maps; what does not fit gets smaller maps, then none, which a note says. "
                      "Films keep up to twice as much from frame to frame",
       .sweep = {16, 64, 128, 1024},
       .required = from_maps},
      {.name = "size_px",
       .member = &LampKnobs::size_px,
       .unit = "px",
       .lowest = 64,
       .highest = 4096,
       .levels = {256, 512, 1024, 2048},
       .description =
           "most texels along a side of a map, to the power of two below; lights that show small and pictures of "
           "few pixels have fewer",
       .sweep = {256, 512, 1024, 2048},
       .required = from_maps},
      {.name = "pixel_places",
       .member = &LampKnobs::pixel_places,
       .lowest = 0,
       .highest = 1024,
       .levels = {0, 4, 9, 64},
       .description = "lookups spread over a pixel that covers more of a shadow map than one lookup reads; with fewer, "
                      "edges of shadows jump from pixel to pixel. 0: one lookup at the pixel's middle",
       .sweep = {0, 4, 9, 16, 64},
       .required = from_maps},
      {.name = "draws",
       .member = &LampKnobs::draws,
       .lowest = 0,
       .highest = double(1 << 30),
       .levels = {double(1 << 21)},
       .description = "room for draw commands of all these views; a frame that needs more is refused and says how many",
       .kind = Trades::time,
       .sweep = {double(1 << 22), double(1 << 21)},
       .required = from_maps},
  };
  return rows;
}

}  // namespace candela
