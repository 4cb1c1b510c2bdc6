#pragma once
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "math/bounds.h"
#include "scene/scene.h"

namespace candela {

// What the bounds of a skinned or morphed section are made from, so that a frame needs no walk over its vertices.
struct DeformationBounds {
  struct JointBox {
    uint32_t joint = 0;  // within the skin
    Aabb box;            // of the undeformed vertices that this joint moves
  };
  std::vector<JointBox> joints;    // only joints with influence, by index
  std::vector<Aabb> morph_deltas;  // per morph target, of its position deltas; empty box: the target moves nothing
  uint32_t joint_end = 0;          // one past the highest joint index in the attribute, used or not
  bool convex = true;  // weights are not negative and sum to 1, so a vertex lies between its joints' positions
};
DeformationBounds measure_deformation(const MeshSection& section);

// Fills MeshSection::deformation_bounds of every skinned or morphed section. To be called once, when vertices are
// final.
void prepare_deformation_bounds(Scene& scene);

// Box that surely holds a deformed section in float arithmetic on the device; infinite where it cannot be told (a
// matrix with non-finite numbers or a projective row), so that nothing is culled wrongly. target_from_bind: per joint
// of the skin; empty: not skinned, then `target_from_local` applies.
DAabb deformed_bounds(const MeshSection& section, const DeformationBounds& deformation,
                      std::span<const glm::dmat4> target_from_bind, std::span<const float> morph_weights,
                      const glm::dmat4& target_from_local);

// The same for vertices that do not move.
DAabb padded_bounds(const DAabb& local, const glm::dmat4& target_from_local);

DAabb infinite_bounds();
bool is_finite(const DAabb& box);
bool is_finite_affine(const glm::dmat4& m);

}  // namespace candela
