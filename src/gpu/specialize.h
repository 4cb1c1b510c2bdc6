#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "graph/pipeline_desc.h"

namespace candela::gpu {

// The code without what its specialization constants leave out: branches that are never taken, and functions that
// nothing calls any more. Constants stay and are given to the driver as before. Drivers drop the same code, but only
// after they have inlined all of it: lavapipe 25.0.7 takes 90 MB on the way for a shader of surfaces, of which a frame
// uses a third. What is computed does not change. Code of a form that is not known here stays as it is.
std::vector<uint32_t> specialized(std::span<const uint32_t> spirv, std::span<const SpecConstant> constants);

}  // namespace candela::gpu
