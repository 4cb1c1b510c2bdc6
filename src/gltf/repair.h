#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "gltf/validate/validate.h"

namespace candela::gltf {

// Mends, before the checks, what can be mended without a guess (docs/using/inputs.md has the table): hierarchies with a
// node under two parents or a root that is a child, matrices beside translation, rotation and scale, quaternions of
// zero, ranges and cones of lights, integer colours and texture coordinates that are not marked as normalized,
// primitives without vertices, and textures that are not there. Each repair is a finding that is not fatal, under the
// code that the Khronos validator gives the fault.
std::vector<Finding> repair_gltf(nlohmann::json& document);

}  // namespace candela::gltf
