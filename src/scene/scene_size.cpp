#include "scene/scene_size.h"

#include <algorithm>
#include <cmath>

#include "scene/frame_data.h"
#include "scene/pose.h"

namespace candela {

double scene_size_m(const Scene& scene) {
  const DAabb bounds = world_bounds(scene, evaluate_pose(scene, {}, 0));
  const double size_m = bounds.empty() ? 0 : 2 * glm::length(bounds.extent());
  return std::isfinite(size_m) ? size_m : 0;
}

double least_light_distance_m(const Scene& scene) {
  const double size_m = scene_size_m(scene);
  return size_m > 0 ? std::clamp(1e-6 * size_m, 1e-15, 1e15) : 0.01;
}

}  // namespace candela
