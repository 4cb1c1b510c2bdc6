#pragma once
#include "passes/shared/light_lists.h"
#include "passes/shared/pass.h"
#include "shared/lights.h"

namespace candela {

// Runs the bound pipeline over the segments of the lights' chunks (passes/lights/light_assign.h): a group each. push:
// what differs between the passes.
inline void dispatch_segments(CommandList& commands, const LightGridShape& grid, const LightBoxes& boxes,
                              shared::LightSegmentsPush push) {
  push.bounds = commands.address(boxes.bounds);
  push.chunks = commands.address(boxes.chunks);
  push.dispatch = commands.address(boxes.dispatch);
  push.cells = grid.cells;
  commands.push(push);
  commands.dispatch(shared::light_segments * shared::light_chunk_cells);
}

}  // namespace candela
