#pragma once
#include <string>
#include <vector>

#include "passes/shared/light_lists.h"
#include "scene/frame_data.h"
#include "scene/view.h"
#include "shared/scene.h"

namespace candela {

// A frame's light grid: its shape, and each light's box of cells. Cells only decide where a list is kept; which lights
// a cell lists is the GPU's work. Boxes are conservative: lights are inflated, tiles widened by what
// rounding can do to a shaded point's place, and a light whose box would be unbounded is one of every cell.
struct LightGrid {
  shared::LightGrid constants{};
  std::vector<shared::LightBounds> bounds;  // lights that reach some cells but not all, in light order
  std::vector<shared::LightChunk> chunks;
  shared::LightDispatch dispatch{};  // of the chunks
  std::vector<uint32_t> globals;     // lights of every cell: words of a mask, or ascending indices
  LightGridShape shape;
  std::string note;  // for the user; empty mostly
  void clear();      // as new, but for the tables' memory
};

// data: its lights as they are uploaded; of those in groups no place is known, but where clusters of them are: then the
// boxes of all lights are the GPU's work (passes/lights/light_bounds.h), and the shape has room for the most that there
// can be. constants: the frame's, for the camera's axes as the GPU has them. farthest_m: depth
// beyond which nothing is drawn, infinity when unknown. reach_m: the largest distance of anything drawn from the
// camera, likewise.
// grid: whatever it held, its memory is used again.
void make_light_grid(LightGridKind kind, const FrameData& data, const shared::FrameConstants& constants,
                     double farthest_m, double reach_m, const LightKnobs& knobs, LightGrid& grid);
inline LightGrid make_light_grid(LightGridKind kind, const FrameData& data, const shared::FrameConstants& constants,
                                 double farthest_m, double reach_m, const LightKnobs& knobs) {
  LightGrid grid;
  make_light_grid(kind, data, constants, farthest_m, reach_m, knobs, grid);
  return grid;
}

// What the GPU's tests get for one light with a range, whatever the grid. For tests.
shared::LightBounds inflated_bounds(const LightItem& light, const shared::FrameConstants& constants);

// Gives every point and spot light without range the range at which it falls to floor_lux; 0 leaves them. Returns how
// many got one.
uint32_t apply_light_floor(std::vector<LightItem>& lights, float floor_lux);

}  // namespace candela
