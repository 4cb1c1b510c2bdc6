#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace candela {

// Indices of places such that neighbours in the order are neighbours in space: along the curve of Morton 1966, ten bits
// of each coordinate. Equal places stay in their order.
std::vector<uint32_t> spatial_order(std::span<const glm::vec3> places);

}  // namespace candela
