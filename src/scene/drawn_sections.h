#pragma once
#include <memory>
#include <vector>

#include "scene/deformation_bounds.h"
#include "scene/pose.h"
#include "scene/scene.h"

namespace candela {

// The node's space from that of one of its instances (EXT_mesh_gpu_instancing), in double.
glm::dmat4 node_from_instance(const Instances& instances, size_t i);

// The matrices of one skin at a pose, in double. `target` is the space of DrawnSections.
struct SkinMatrices {
  std::vector<glm::dmat4> target_from_bind;  // per joint
  int first = -1;                            // into FrameData::joint_matrices; -1: not written there yet
  bool mirrored = false;                     // most joints turn the surface inside out
};

// How one section of one node is deformed at a pose.
struct SectionDeformation {
  std::shared_ptr<const DeformationBounds> bounds;
  bool skinned = false, morphed = false;
  explicit operator bool() const { return skinned || morphed; }
};

// What of a posed scene is drawn, how it is deformed and where it lies, in a target space: the world, or relative to a
// camera. World bounds and frame data ask the same questions here, so that both see the same things.
class DrawnSections {
 public:
  DrawnSections(const Scene& scene, const Pose& pose, const glm::dmat4& target_from_world);

  static bool can_be_drawn(const MeshSection& section) { return !section.index.empty() && !section.bounds.empty(); }
  bool has_visible_mesh(size_t node) const { return scene_.nodes[node].mesh >= 0 && pose_.node_visible[node]; }
  size_t instance_count(size_t node) const;
  // The camera is subtracted first, while all numbers are double; what follows is near the camera and small.
  glm::dmat4 target_from_node(size_t node) const { return target_from_world_ * pose_.world_from_node[node]; }
  glm::dmat4 target_from_instance(const glm::dmat4& target_from_node, size_t node, size_t instance) const;
  SkinMatrices& skin(int skin);

  // A section whose joints lie outside the skin cannot be skinned; it is drawn where its node stands.
  SectionDeformation deformation_of(const MeshSection& section, size_t node) const;

  // Holds every vertex; infinite where that cannot be told. target_from_local does not matter to a skinned section.
  DAabb bounds_of(const MeshSection& section, size_t node, const SectionDeformation& deformation,
                  const glm::dmat4& target_from_local);

 private:
  bool weights_matter(size_t node) const;

  const Scene& scene_;
  const Pose& pose_;
  glm::dmat4 target_from_world_;
  std::vector<SkinMatrices> skins_;
  std::vector<bool> weights_animated_;  // per node, by any animation of the file
};

}  // namespace candela
