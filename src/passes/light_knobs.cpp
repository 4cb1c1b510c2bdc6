#include "passes/light_knobs.h"

namespace candela {

namespace {
// What makes lists and what walks them.
const std::vector<std::string_view> list_passes = {"tile_depth", "light_assign", "light_scan", "light_fill", "light_sort", "shade_forward", "transparent"};
}  // namespace

std::span<const Knob<LightKnobs>> LightKnobs::knob_table() {
  static const Knob<LightKnobs> table[] = {
      {"test",
       &LightKnobs::test,
       "",
       0,
       3,
       {3},
       "bounding test of light against cell: looser ones list lights that give nothing",
       {"aabb", "cone-sphere", "capsule", "capsule-joint"}, Trades::time, {0, 1, 2, 3}, list_passes},
      {"mask",
       &LightKnobs::mask,
       "",
       0,
       1,
       {1},
       "forward-plus: test a tile's occupied depth slices too (2.5D)", {}, Trades::time, {0, 1}, list_passes},
      {"list",
       &LightKnobs::list,
       "",
       0,
       2,
       {0},
       "how a cell stores its lights: a bit for each of the frame's, or only its own; auto takes what is smaller and "
       "quicker",
       {"auto", "bitmask", "compact"}, Trades::time, {1, 2, 0}, list_passes},
      {"tile_px",
       &LightKnobs::tile_px,
       "px",
       8,
       256,
       {32},
       "clustered: side of a tile; smaller ones list fewer lights and are more",
       {}, Trades::time, {8, 16, 64, 128, 32}, list_passes},
      {"slices_per_octave",
       &LightKnobs::slices_per_octave,
       "",
       1,
       16,
       {4},
       "clustered: depth slices for each doubling of the depth (1, 2, 4, 8 or 16)",
       {}, Trades::time, {1, 2, 8, 16, 4}, list_passes},
      {"few",
       &LightKnobs::few,
       "",
       0,
       1 << 20,
       {8},
       "with this many lights or fewer no lists are made and each pixel walks all",
       {}, Trades::time, {0, 64, 1024, 8}, list_passes},
      {"memory_mb",
       &LightKnobs::memory_mb,
       "MiB",
       1,
       1 << 20,
       {512},
       "lists that would take more get larger cells; no light is ever left out",
       {}, Trades::time, {1, 16, 512}, list_passes},
      {"cap",
       &LightKnobs::cap,
       "",
       0,
       1 << 20,
       {0},
       "walk no more than this many lights a cell, as other renderers do; 0: all. Loses light and says how much",
       {}, Trades::error, {4, 16, 64, 256, 0}, list_passes},
      {"floor_lux",
       &LightKnobs::floor_lux,
       "lux",
       0,
       1e6,
       {1, 0.1, 0.01, 0},
       "a light without range ends where it gives less than this; 0: nowhere, so that every pixel walks it",
       {}, Trades::error, {}, list_passes},
  };
  return table;
}

}  // namespace candela
