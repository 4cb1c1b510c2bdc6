#include "reference/deform.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

namespace candela {
namespace {

glm::mat4 blended_joints(const MeshSection& section, const FrameData& frame, const Deformation& deformation, size_t v) {
  glm::mat4 sum(0.0f);
  const auto add = [&](const std::vector<glm::u16vec4>& joints, const std::vector<glm::vec4>& weights) {
    if (joints.empty() || weights.empty()) return;
    for (int i = 0; i < 4; ++i)
      if (weights[v][i] != 0) sum += weights[v][i] * frame.joint_matrices[deformation.first_joint + joints[v][i]];
  };
  add(section.joints0, section.weights0);
  add(section.joints1, section.weights1);
  return sum;
}

void morph(const MeshSection& section, const FrameData& frame, const Deformation& deformation, size_t v,
           glm::vec3& position, glm::vec3& normal, glm::vec3& tangent) {
  for (uint32_t t = 0; t < deformation.weight_count; ++t) {
    const float weight = frame.morph_weights[deformation.first_weight + t];
    if (weight == 0) continue;
    const MorphTarget& target = section.morph[t];
    if (!target.position.empty()) position += weight * target.position[v];
    if (!target.normal.empty()) normal += weight * target.normal[v];
    if (!target.tangent.empty()) tangent += weight * target.tangent[v];
  }
}

// What the chunk lacks of all the body's vertices are no numbers: trees leave such triangles out.
DeformedVertices metaball_chunk(const std::vector<glm::vec3>& all, uint32_t chunk) {
  constexpr size_t room = 3 * size_t(metaball_chunk_triangles);
  DeformedVertices out;
  out.position.assign(room, glm::vec3(std::numeric_limits<float>::quiet_NaN()));
  const size_t first = std::min(room * chunk, all.size()), count = std::min(room, all.size() - first);
  std::copy_n(all.begin() + ptrdiff_t(first), count, out.position.begin());
  return out;
}

}  // namespace

DeformedVertices deform_vertices(const Scene& scene, const FrameData& frame, const Deformation& deformation) {
  const MeshSection& section = scene.meshes[deformation.mesh].sections[deformation.section];
  const size_t count = section.position.size();
  DeformedVertices out;
  out.position.resize(count);
  out.normal.resize(section.normal.empty() ? 0 : count);
  out.tangent.resize(section.tangent.empty() ? 0 : count);
  const auto deform_one = [&](size_t v) {
    glm::vec3 position = section.position[v];
    glm::vec3 normal = out.normal.empty() ? glm::vec3(0) : section.normal[v];
    glm::vec3 tangent = out.tangent.empty() ? glm::vec3(0) : glm::vec3(section.tangent[v]);
    morph(section, frame, deformation, v, position, normal, tangent);
    float handedness = 1;
    if (deformation.joint_count > 0) {
      const glm::mat4 m = blended_joints(section, frame, deformation, v);
      position = glm::vec3(m * glm::vec4(position, 1.0f));
      // Normals by the cofactor matrix, which keeps them perpendicular under non-uniform scales.
      const glm::vec3 a(m[0]), b(m[1]), c(m[2]);
      const glm::vec3 bc = glm::cross(b, c), ca = glm::cross(c, a), ab = glm::cross(a, b);
      handedness = glm::dot(a, bc) < 0 ? -1.0f : 1.0f;
      normal = handedness * (bc * normal.x + ca * normal.y + ab * normal.z);
      tangent = glm::mat3(m) * tangent;
    }
    out.position[v] = position;
    if (!out.normal.empty()) out.normal[v] = normal;
    if (!out.tangent.empty()) out.tangent[v] = glm::vec4(tangent, handedness * section.tangent[v].w);
  };
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 4096), [&](const tbb::blocked_range<size_t>& range) {
    for (size_t v = range.begin(); v != range.end(); ++v) deform_one(v);
  });
  return out;
}

std::vector<DeformedVertices> deform_all(const Scene& scene, const FrameData& frame, bool polygons) {
  std::vector<DeformedVertices> out;
  std::vector<glm::vec3> vertices;  // of the body at hand, whose chunks follow one another
  for (const Deformation& d : frame.deformations) {
    if (d.body < 0) {
      out.push_back(deform_vertices(scene, frame, d));
      continue;
    }
    if (polygons && d.chunk == 0) vertices = polygonise(frame.metaballs[size_t(d.body)]);
    out.push_back(polygons ? metaball_chunk(vertices, d.chunk) : DeformedVertices{});
  }
  return out;
}

}  // namespace candela
