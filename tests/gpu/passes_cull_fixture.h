#pragma once
#include <limits>

#include "math/bounds.h"
#include "math/transforms.h"
#include "passes/geometry/cull.h"
#include "passes/geometry/cull_compact.h"
#include "passes_fixture.h"
#include "shared/cull.h"
#include "shared/scene.h"

namespace candela::gpu::test {

inline constexpr float infinite = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();

inline shared::Item item(glm::vec3 centre, glm::vec3 extent, uint32_t number) {
  shared::Item out{};
  out.bounds_centre = centre;
  out.bounds_extent = extent;
  out.first_index = 1000 + 7 * number;  // every item has its own, so that a wrong place shows
  out.index_count = 3 + number % 11;
  return out;
}

inline glm::vec3 random_vector(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

inline std::vector<shared::Item> random_items(size_t count, Rng& rng) {
  std::vector<shared::Item> items;
  for (size_t i = 0; i < count; ++i)
    items.push_back(
        item(random_vector(rng, 30), glm::abs(random_vector(rng, rng.uniform() < 0.1 ? 20 : 1)), uint32_t(i)));
  return items;
}

inline glm::dmat4 rotation() { return glm::mat4_cast(glm::normalize(glm::dquat(0.8, 0.3, -0.4, 0.2))); }

// How far the box reaches over the planes' inner side, in double, on the numbers that the device gets; the least of all
// planes. And the scale by which rounding of the device's arithmetic is measured.
struct Margin {
  double reach = std::numeric_limits<double>::infinity(), scale = 0;
};
inline Margin margin(const shared::Item& item, std::span<const glm::vec4> planes) {
  Margin least;
  for (const glm::vec4& p : planes) {
    const glm::dvec3 n(p), c(item.bounds_centre), e(item.bounds_extent);
    const double outwards = glm::dot(glm::abs(n), e);
    const double reach = glm::dot(n, c) + double(p.w) + outwards;
    if (reach >= least.reach) continue;
    least = {reach, glm::dot(glm::abs(n), glm::abs(c)) + outwards + std::abs(double(p.w))};
  }
  return least;
}
inline bool is_finite(const shared::Item& item) {
  const glm::vec3 sum = item.bounds_centre + item.bounds_extent;
  return std::isfinite(sum.x + sum.y + sum.z);
}

// Cuts runs of the given lengths into groups, as the frame's upload does.
inline std::vector<shared::CullGroup> cull_groups(const std::vector<uint32_t>& runs) {
  std::vector<shared::CullGroup> groups;
  uint32_t first = 0;
  for (uint32_t r = 0; r < runs.size(); ++r) {
    const uint32_t first_group = uint32_t(groups.size());
    for (uint32_t at = 0; at < runs[r]; at += shared::cull_group_size) {
      const uint32_t count = std::min(shared::cull_group_size, runs[r] - at);
      groups.push_back({first + at, count, r, first_group, at + count == runs[r] ? 1u : 0u, 1});
    }
    first += runs[r];
  }
  return groups;
}

}  // namespace candela::gpu::test
