#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace candela::gltf {
// A primitive of glTF mode 0 to 6 as a list of points, lines or triangles in the winding order of glTF 2.0
// section 3.7.2.1. Left-over vertices that make no whole element are dropped.
Topology topology_of(int mode);
std::vector<uint32_t> expanded_to_list(int mode, std::span<const uint32_t> vertices);
bool has_leftovers(int mode, size_t vertices);
}  // namespace candela::gltf
