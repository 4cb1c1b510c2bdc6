#pragma once
#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

#include "base/error.h"
#include "look/motion.h"
#include "scene/scene.h"
#include "scene/spline.h"

namespace candela {

// The files of paths and instances (docs/using/paths.md). An error (input) names file and line, and nothing is read
// then.

// x y z a line.
Expected<std::vector<glm::dvec3>> read_points(const std::filesystem::path& file);
// Time in seconds and parameter a line, the times ascending; two lines of one time are a jump.
Expected<TimeMap> read_times(const std::filesystem::path& file);
// Three vectors an instance, a line each or all nine numbers in one; the request says what they are.
Expected<Instances> read_instances(const std::filesystem::path& file, const InstancesRequest& request);

}  // namespace candela
