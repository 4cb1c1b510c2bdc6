#include "scene/drawn_sections.h"

#include "math/transforms.h"
#include "scene/metaballs.h"

namespace candela {
glm::dmat4 node_from_instance(const Instances& instances, size_t i) {
  const glm::dvec3 translation = instances.translation.empty() ? glm::dvec3(0) : glm::dvec3(instances.translation[i]);
  const glm::dvec3 scale = instances.scale.empty() ? glm::dvec3(1) : glm::dvec3(instances.scale[i]);
  glm::dquat rotation(1, 0, 0, 0);
  if (!instances.rotation.empty()) {
    const glm::dquat q(instances.rotation[i]);
    const double length = glm::length(q);
    if (length > 1e-12) rotation = q / length;
  }
  return compose_trs(translation, rotation, scale);
}

namespace {

// The specification fixes the last row of inverse bind matrices; files hold it with rounding errors.
glm::dmat4 affine(glm::dmat4 m) {
  m[0][3] = m[1][3] = m[2][3] = 0, m[3][3] = 1;
  return m;
}

void make_skin_matrices(const Skin& skin, const Pose& pose, const glm::dmat4& target_from_world, SkinMatrices& out) {
  out.target_from_bind.reserve(skin.joints.size());
  size_t mirrored = 0;
  for (size_t j = 0; j < skin.joints.size(); ++j) {
    glm::dmat4 m = target_from_world * pose.world_from_node[size_t(skin.joints[j])];
    if (j < skin.inverse_bind.size()) m = m * affine(skin.inverse_bind[j]);
    if (glm::determinant(glm::dmat3(m)) < 0) ++mirrored;
    out.target_from_bind.push_back(m);
  }
  out.mirrored = 2 * mirrored > skin.joints.size();
}

std::vector<bool> nodes_with_animated_weights(const Scene& scene) {
  std::vector<bool> animated(scene.nodes.size(), false);
  for (const Animation& animation : scene.animations)
    for (const AnimationChannel& channel : animation.channels)
      if (channel.path == TargetPath::node_weights && channel.object >= 0 && size_t(channel.object) < animated.size())
        animated[size_t(channel.object)] = true;
  return animated;
}

}  // namespace

DrawnSections::DrawnSections(const Scene& scene, const Pose& pose, const glm::dmat4& target_from_world)
    : scene_(scene),
      pose_(pose),
      target_from_world_(target_from_world),
      skins_(scene.skins.size()),
      weights_animated_(nodes_with_animated_weights(scene)) {}

size_t DrawnSections::instance_count(size_t node) const {
  const auto& instances = scene_.nodes[node].instances;
  return instances ? instances->count : 1;
}

glm::dmat4 DrawnSections::target_from_instance(const glm::dmat4& target_from_node, size_t node, size_t instance) const {
  const auto& instances = scene_.nodes[node].instances;
  return instances ? target_from_node * node_from_instance(*instances, instance) : target_from_node;
}

SkinMatrices& DrawnSections::skin(int skin) {
  SkinMatrices& matrices = skins_[size_t(skin)];
  if (matrices.target_from_bind.empty())
    make_skin_matrices(scene_.skins[size_t(skin)], pose_, target_from_world_, matrices);
  return matrices;
}

SectionDeformation DrawnSections::deformation_of(const MeshSection& section, size_t node) const {
  SectionDeformation result;
  const int skin = scene_.nodes[node].skin;
  result.morphed = !section.morph.empty() && weights_matter(node);
  result.skinned = skin >= 0 && !section.joints0.empty() && !section.weights0.empty();
  if (!result) return result;
  result.bounds = section.deformation_bounds;
  if (!result.bounds) result.bounds = std::make_shared<const DeformationBounds>(measure_deformation(section));
  if (result.skinned) result.skinned = result.bounds->joint_end <= scene_.skins[size_t(skin)].joints.size();
  return result;
}

DAabb DrawnSections::bounds_of(const MeshSection& section, size_t node, const SectionDeformation& deformation,
                               const glm::dmat4& target_from_local) {
  if (section.metaballs >= 0) {
    const Metaballs& body = pose_.metaballs[size_t(section.metaballs)];
    const DAabb box = metaball_bounds(pose_metaballs(body, pose_), body.threshold);
    return box.empty() ? box : padded_bounds(box, target_from_local);
  }
  if (!deformation)
    return padded_bounds({glm::dvec3(section.bounds.min), glm::dvec3(section.bounds.max)}, target_from_local);
  std::span<const float> weights;
  if (deformation.morphed) weights = pose_.node_weights[node];
  std::span<const glm::dmat4> joints;
  if (deformation.skinned) joints = skin(scene_.nodes[node].skin).target_from_bind;
  return deformed_bounds(section, *deformation.bounds, joints, weights, target_from_local);
}

// Weights that are zero and that no animation drives leave the vertices as they are. Animated ones count even at zero,
// so that the frames of a sequence keep one plan.
bool DrawnSections::weights_matter(size_t node) const {
  if (weights_animated_[node]) return true;
  for (float w : pose_.node_weights[node])
    if (w != 0) return true;
  return false;
}

}  // namespace candela
