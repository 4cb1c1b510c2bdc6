#pragma once
#include <cstdint>
#include <span>

#include "scene/scene.h"

namespace candela {
// Makes new vertices out of old ones: vertex i becomes a copy of vertex source[i], in every attribute and morph target.
// The index array is left alone; what was measured from the old vertices (deformation_bounds) is dropped.
void remap_vertices(MeshSection& section, std::span<const uint32_t> source);
}  // namespace candela
