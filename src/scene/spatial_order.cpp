#include "scene/spatial_order.h"

#include <tbb/parallel_sort.h>

#include <algorithm>

#include "math/bounds.h"

namespace candela {
namespace {

// Ten bits of each coordinate in turn.
uint32_t morton(glm::uvec3 cell) {
  uint32_t code = 0;
  for (uint32_t bit = 0; bit < 10; ++bit)
    for (int axis = 0; axis < 3; ++axis) code |= (cell[axis] >> bit & 1) << (3 * bit + uint32_t(axis));
  return code;
}

}  // namespace

std::vector<uint32_t> spatial_order(std::span<const glm::vec3> places) {
  Aabb box;
  for (const glm::vec3& p : places) box.add(p);
  const glm::dvec3 sides = glm::dvec3(box.max) - glm::dvec3(box.min);
  const double side = std::max({sides.x, sides.y, sides.z, 1e-30});
  std::vector<std::pair<uint32_t, uint32_t>> on_curve(places.size());  // code, index
  for (uint32_t i = 0; i < on_curve.size(); ++i) {
    const glm::dvec3 fraction = (glm::dvec3(places[i]) - glm::dvec3(box.min)) / side;
    on_curve[i] = {morton(glm::uvec3(glm::clamp(fraction, 0.0, 1.0) * 1023.0)), i};
  }
  tbb::parallel_sort(on_curve);
  std::vector<uint32_t> order;
  order.reserve(on_curve.size());
  for (const auto& [code, i] : on_curve) order.push_back(i);
  return order;
}

}  // namespace candela
