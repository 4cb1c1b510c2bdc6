#pragma once
#include <string_view>
#include <vector>

#include "graph/plan.h"
#include "job/dump_request.h"

namespace candela {

// Name of a request that stands for every image of the frame: `render --steps`.
inline constexpr std::string_view every_image = "*";

// Of each pass of the plan the images that it writes, as they stand behind it: of mips the first few, of layered images
// some layers, of 3D images some slices.
std::vector<DumpRequest> requests_of_steps(const FramePlan& plan);

}  // namespace candela
