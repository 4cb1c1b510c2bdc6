#include "passes/shared/light_knobs.h"

namespace candela {

std::span<const Knob> LightKnobs::table() {
  static const Knob table[] = {
      {.name = "test",
       .member = &LightKnobs::test,
       .lowest = 0,
       .highest = 3,
       .levels = {3},
       .description = "bounding test of light against cell: looser ones list lights that give nothing",
       .choices = {"aabb", "cone-sphere", "capsule", "capsule-joint"},
       .kind = Trades::time,
       .sweep = {0, 1, 2, 3}},
      {.name = "mask",
       .member = &LightKnobs::mask,
       .lowest = 0,
       .highest = 1,
       .levels = {1},
       .description = "forward-plus: test a tile's occupied depth slices too (2.5D)",
       .kind = Trades::time,
       .sweep = {0, 1}},
      {.name = "list",
       .member = &LightKnobs::list,
       .lowest = 0,
       .highest = 2,
       .levels = {0},
       .description =
           "how a cell stores its lights: a bit for each of the frame's, or only its own; auto takes what is "
           "smaller and quicker",
       .choices = {"auto", "bitmask", "compact"},
       .kind = Trades::time,
       .sweep = {1, 2, 0}},
      {.name = "order",
       .member = &LightKnobs::order,
       .lowest = 0,
       .highest = 2,
       .levels = {0},
       .description =
           "how a cell's lights come into order: sorted, or filled so by a few groups of threads (not with cap); "
           "auto: segments on a CPU",
       .choices = {"auto", "sorted", "segments"},
       .kind = Trades::time,
       .sweep = {1, 2, 0}},
      {.name = "tile_px",
       .member = &LightKnobs::tile_px,
       .unit = "px",
       .lowest = 8,
       .highest = 256,
       .levels = {32},
       .description = "clustered: side of a tile; smaller ones list fewer lights and are more",
       .kind = Trades::time,
       .sweep = {8, 16, 64, 128, 32}},
      {.name = "slices_per_octave",
       .member = &LightKnobs::slices_per_octave,
       .lowest = 1,
       .highest = 16,
       .levels = {4},
       .description = "clustered: depth slices for each doubling of the depth (1, 2, 4, 8 or 16)",
       .kind = Trades::time,
       .sweep = {1, 2, 8, 16, 4},
       .only = {1, 2, 4, 8, 16}},
      {.name = "few",
       .member = &LightKnobs::few,
       .lowest = 0,
       .highest = 1 << 20,
       .levels = {8},
       .description = "with this many lights or fewer no lists are made and each pixel walks all",
       .kind = Trades::time,
       .sweep = {0, 64, 1024, 8}},
      {.name = "memory_mb",
       .member = &LightKnobs::memory_mb,
       .unit = "MiB",
       .lowest = 1,
       .highest = 1 << 20,
       .levels = {512},
       .description = "lists that would take more get larger cells; no light is ever left out",
       .kind = Trades::time,
       .sweep = {1, 16, 512}},
      {.name = "sift_over",
       .member = &LightKnobs::sift_over,
       .lowest = 0,
       .highest = 1 << 30,
       .levels = {64},
       .description =
           "in lists of more lights each point first looks which of them reach it; then those of its group are shaded",
       .kind = Trades::time,
       .sweep = {0, 1 << 30, 64}},
      {.name = "cap",
       .member = &LightKnobs::cap,
       .lowest = 0,
       .highest = 1 << 20,
       .levels = {0},
       .description =
           "walk no more than this many lights a cell, as other renderers do; 0: all. Loses light and says how much",
       .sweep = {4, 16, 64, 256, 0}},
  };
  return table;
}

std::span<const Knob> LightRangeKnobs::table() {
  static const Knob table[] = {
      {.name = "lost",
       .member = &LightRangeKnobs::lost,
       .lowest = 0,
       .highest = 1,
       .levels = {0.05, 0.02, 0.005, 0},
       .description =
           "lights without range end where no surface loses more of its light than this, or of a hundredth of "
           "what is white; of very many, stand-ins give what lies beyond; 0: nowhere, so that every pixel walks them",
       .sweep = {0.05, 0.02, 0.005, 0}},
      {.name = "floor_lux",
       .member = &LightRangeKnobs::floor_lux,
       .unit = "lux",
       .lowest = LightRangeKnobs::by_loss,
       .highest = 1e6,
       .levels = {LightRangeKnobs::by_loss, LightRangeKnobs::by_loss, LightRangeKnobs::by_loss, 0},
       .description = "a light without range ends where it gives less than this; 0: nowhere; -1: as lights.lost says",
       .sweep = {1, 0.1, 0.01, 0}},
  };
  return table;
}

}  // namespace candela
