#include <cmath>

#include "gltf/mikktspace.h"
#include "gltf/vertex_remap.h"

namespace candela {
namespace {

// Of the triangle's plane, counter-clockwise seen from its tip; a triangle without area gets any unit vector.
glm::vec3 face_normal(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double length = glm::length(normal);
  return length > 0 && std::isfinite(length) ? glm::vec3(normal / length) : glm::vec3(0, 0, 1);
}

// The flat normals of the fully morphed triangles, as deltas: exact for a single target at weight 0 or 1.
void add_morph_normals(const std::vector<glm::vec3>& position, const std::vector<glm::vec3>& normal,
                       MorphTarget& target) {
  target.normal.clear();
  if (target.position.empty()) return;
  target.normal.resize(position.size());
  for (size_t v = 0; v + 2 < position.size(); v += 3) {
    glm::dvec3 corner[3];
    for (size_t i = 0; i < 3; ++i) corner[i] = glm::dvec3(position[v + i]) + glm::dvec3(target.position[v + i]);
    const glm::vec3 morphed = face_normal(corner[0], corner[1], corner[2]);
    for (size_t i = 0; i < 3; ++i) target.normal[v + i] = morphed - normal[v + i];
  }
}

}  // namespace

void generate_flat_normals(MeshSection& section) {
  if (section.topology != Topology::triangles) return;
  section.index.resize(section.index.size() / 3 * 3);
  const std::vector<uint32_t> corners = std::move(section.index);
  section.normal.clear();
  section.tangent.clear();
  for (MorphTarget& target : section.morph) target.tangent.clear();
  remap_vertices(section, corners);
  section.index.resize(corners.size());
  for (uint32_t i = 0; i < section.index.size(); ++i) section.index[i] = i;

  const std::vector<glm::vec3>& p = section.position;
  section.normal.resize(p.size());
  for (size_t v = 0; v < p.size(); v += 3)
    section.normal[v] = section.normal[v + 1] = section.normal[v + 2] = face_normal(p[v], p[v + 1], p[v + 2]);
  for (MorphTarget& target : section.morph) add_morph_normals(p, section.normal, target);
}

}  // namespace candela
