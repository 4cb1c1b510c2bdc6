#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "base/error.h"
#include "scene/scene.h"

namespace candela {

// Where each section's vertices and indices lie in the two buffers that hold the whole scene, in 4-byte words. Only
// sections of nodes that the default scene reaches, and only attributes that some pass reads: no normals of unlit
// surfaces, no UVs without a texture, no tangents without a normal map.
struct SectionLayout {
  static constexpr uint32_t absent = 0xffffffffu;
  bool used = false;
  uint32_t geometry = 0;  // running number among used sections
  uint32_t position = absent, normal = absent, tangent = absent, uv0 = absent, uv1 = absent, color = absent;
  uint32_t joints0 = absent, weights0 = absent, joints1 = absent, weights1 = absent;
  uint32_t morph_table = absent;
  uint32_t first_index = 0, index_count = 0;
};
// Of a section's texture coordinates: where its relief ends. Four words before those that its heights are read by.
struct UvBounds {
  glm::vec2 least{0}, most{0};
};
UvBounds uv_bounds(const std::vector<glm::vec2>& uvs);

struct GeometryLayout {
  std::vector<std::vector<SectionLayout>> sections;  // by mesh, by section
  uint32_t geometry_count = 0;
  uint64_t vertex_words = 0, index_count = 0;
  double size_m = 0, least_light_distance_m = 0.01;  // scene/scene_size.h
};

// Error (input) when the scene has more than 2^31 words of vertices or indices.
Expected<GeometryLayout> layout_geometry(const Scene& scene);
// Fills vertex_words words and index_count indices as laid out.
void pack_geometry(const Scene& scene, const GeometryLayout& layout, std::span<uint32_t> words,
                   std::span<uint32_t> indices);

}  // namespace candela
