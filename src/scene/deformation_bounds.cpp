#include "scene/deformation_bounds.h"

#include <algorithm>
#include <cmath>

namespace candela {
namespace {

// Rounding of a float matrix times a float vertex: four products and sums, the casts of matrix and result. A skinned
// vertex adds the blend of up to eight matrices; each morph target adds one more sum. All in units of 2^-24 of the
// summed magnitudes.
constexpr double rounding_unit = 1.0 / 16777216.0;
constexpr double rigid_roundings = 16, skin_roundings = 48;

DAabb to_double(const Aabb& box) { return box.empty() ? DAabb{} : DAabb{glm::dvec3(box.min), glm::dvec3(box.max)}; }

// Transforms a box and widens it by what float arithmetic may be off.
DAabb transformed_and_padded(const DAabb& box, const glm::dmat4& m, double roundings) {
  if (box.empty()) return box;
  if (!is_finite_affine(m) || !is_finite(box)) return infinite_bounds();
  DAabb result = transformed(box, m);
  const glm::dvec3 reach = glm::max(glm::abs(box.min), glm::abs(box.max));
  glm::dvec3 magnitude = glm::abs(glm::dvec3(m[3]));
  for (int i = 0; i < 3; ++i) magnitude += glm::abs(glm::dvec3(m[i])) * reach[i];
  const glm::dvec3 pad = magnitude * (roundings * rounding_unit) + double(std::numeric_limits<float>::min());
  result.min -= pad, result.max += pad;
  return is_finite(result) ? result : infinite_bounds();
}

// Minkowski sum of the vertices' box and the boxes of weight * delta.
DAabb with_morphs(DAabb box, const DeformationBounds& deformation, std::span<const float> weights) {
  if (box.empty()) return box;
  const size_t count = std::min(weights.size(), deformation.morph_deltas.size());
  glm::dvec3 magnitude(0);
  for (size_t t = 0; t < count; ++t) {
    const Aabb& delta = deformation.morph_deltas[t];
    if (delta.empty() || weights[t] == 0) continue;
    const glm::dvec3 a = glm::dvec3(delta.min) * double(weights[t]), b = glm::dvec3(delta.max) * double(weights[t]);
    box.min += glm::min(a, b), box.max += glm::max(a, b);
    magnitude += glm::max(glm::abs(a), glm::abs(b));
  }
  // Partial sums may be larger than the result, and each sum rounds.
  const glm::dvec3 pad =
      (magnitude + glm::max(glm::abs(box.min), glm::abs(box.max))) * (rounding_unit * double(count + 1));
  box.min -= pad, box.max += pad;
  return is_finite(box) ? box : infinite_bounds();
}

void add_influences(const MeshSection& section, const std::vector<glm::u16vec4>& joints,
                    const std::vector<glm::vec4>& weights, std::vector<Aabb>& boxes, DeformationBounds& result) {
  for (size_t v = 0; v < joints.size() && v < weights.size(); ++v) {
    for (int i = 0; i < 4; ++i) {
      const uint32_t joint = joints[v][i];
      result.joint_end = std::max(result.joint_end, joint + 1);
      if (joint >= boxes.size()) boxes.resize(joint + 1);
      if (!(weights[v][i] >= 0)) result.convex = false;
      if (weights[v][i] > 0) boxes[joint].add(section.position[v]);
    }
  }
}

bool weights_sum_to_one(const MeshSection& section) {
  for (size_t v = 0; v < section.weights0.size(); ++v) {
    glm::vec4 w = section.weights0[v];
    if (v < section.weights1.size()) w += section.weights1[v];
    // Within the padding of skin_roundings; a sum farther off scales the vertex away from its joints.
    if (!(std::abs(w.x + w.y + w.z + w.w - 1.0f) <= 2e-6f)) return false;
  }
  return true;
}

}  // namespace

DAabb infinite_bounds() {
  const glm::dvec3 infinity(std::numeric_limits<double>::infinity());
  return {-infinity, infinity};
}

bool is_finite(const DAabb& box) {
  constexpr double highest = std::numeric_limits<float>::max();
  for (int i = 0; i < 3; ++i)
    if (!(std::abs(box.min[i]) <= highest && std::abs(box.max[i]) <= highest)) return false;
  return true;
}

bool is_finite_affine(const glm::dmat4& m) {
  constexpr double highest = std::numeric_limits<float>::max();
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r)
      if (!(std::abs(m[c][r]) <= highest)) return false;
  return m[0][3] == 0 && m[1][3] == 0 && m[2][3] == 0 && m[3][3] == 1;
}

DeformationBounds measure_deformation(const MeshSection& section) {
  DeformationBounds result;
  std::vector<Aabb> boxes;
  add_influences(section, section.joints0, section.weights0, boxes, result);
  add_influences(section, section.joints1, section.weights1, boxes, result);
  if (!section.joints0.empty() && !weights_sum_to_one(section)) result.convex = false;
  for (uint32_t j = 0; j < boxes.size(); ++j)
    if (!boxes[j].empty()) result.joints.push_back({j, boxes[j]});
  for (const MorphTarget& target : section.morph) {
    Aabb box;
    for (const glm::vec3& delta : target.position) box.add(delta);
    result.morph_deltas.push_back(box);
  }
  return result;
}

void prepare_deformation_bounds(Scene& scene) {
  for (Mesh& mesh : scene.meshes)
    for (MeshSection& section : mesh.sections)
      if (!section.joints0.empty() || !section.morph.empty())
        section.deformation_bounds = std::make_shared<const DeformationBounds>(measure_deformation(section));
}

DAabb padded_bounds(const DAabb& local, const glm::dmat4& target_from_local) {
  return transformed_and_padded(local, target_from_local, rigid_roundings);
}

DAabb deformed_bounds(const MeshSection& section, const DeformationBounds& deformation,
                      std::span<const glm::dmat4> target_from_bind, std::span<const float> morph_weights,
                      const glm::dmat4& target_from_local) {
  if (target_from_bind.empty())
    return padded_bounds(with_morphs(to_double(section.bounds), deformation, morph_weights), target_from_local);
  if (!deformation.convex) return infinite_bounds();
  DAabb result;
  for (const DeformationBounds::JointBox& influence : deformation.joints) {
    const DAabb box = with_morphs(to_double(influence.box), deformation, morph_weights);
    result.add(transformed_and_padded(box, target_from_bind[influence.joint], skin_roundings));
  }
  return result;
}

}  // namespace candela
