#include "scene/frame_data.h"

#include <algorithm>
#include <cmath>

#include "math/transforms.h"
#include "scene/deformation_bounds.h"

namespace candela {
namespace {

bool can_be_drawn(const MeshSection& section) { return !section.index.empty() && !section.bounds.empty(); }

DAabb to_double(const Aabb& box) { return {glm::dvec3(box.min), glm::dvec3(box.max)}; }

glm::dmat4 instance_transform(const Instances& instances, size_t i) {
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

size_t instance_count(const Node& node) { return node.instances ? node.instances->count : 1; }

// The matrices of one skin, in double for bounds; floats of the same index are in FrameData.
struct SkinMatrices {
  std::vector<glm::dmat4> target_from_bind;
  int first = -1;         // into FrameData::joint_matrices; -1: not made yet
  bool mirrored = false;  // most joints turn the surface inside out
};

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

// How one section of one node is deformed at this pose.
struct SectionDeformation {
  const DeformationBounds* bounds = nullptr;
  DeformationBounds measured;  // used where loading left none
  bool skinned = false, morphed = false;
  explicit operator bool() const { return skinned || morphed; }
};

// Walks what is drawn in node order; shared by bounds and by the frame, so that both see the same things.
class DrawnSections {
 public:
  DrawnSections(const Scene& scene, const Pose& pose, const glm::dmat4& target_from_world)
      : scene_(scene), pose_(pose), target_from_world_(target_from_world), skins_(scene.skins.size()) {
    find_animated_weights();
  }

  bool visible(const Node& node, size_t n) const { return node.mesh >= 0 && pose_.node_visible[n]; }

  glm::dmat4 target_from_node(size_t n) const { return target_from_world_ * pose_.world_from_node[n]; }

  SkinMatrices& skin(int s) {
    SkinMatrices& matrices = skins_[size_t(s)];
    if (matrices.target_from_bind.empty())
      make_skin_matrices(scene_.skins[size_t(s)], pose_, target_from_world_, matrices);
    return matrices;
  }

  // A section whose joints lie outside the skin cannot be skinned; it is drawn where its node stands.
  void deformation_of(const MeshSection& section, size_t n, SectionDeformation& out) const {
    const Node& node = scene_.nodes[n];
    const bool joints = node.skin >= 0 && !section.joints0.empty() && !section.weights0.empty();
    out.morphed = !section.morph.empty() && weights_matter(n);
    out.skinned = joints;
    if (!out) return;
    out.bounds = section.deformation_bounds.get();
    if (!out.bounds) {
      out.measured = measure_deformation(section);
      out.bounds = &out.measured;
    }
    if (joints) out.skinned = out.bounds->joint_end <= scene_.skins[size_t(node.skin)].joints.size();
  }

  DAabb bounds_of(const MeshSection& section, size_t n, const SectionDeformation& deformation,
                  const glm::dmat4& target_from_local) {
    if (!deformation) return padded_bounds(to_double(section.bounds), target_from_local);
    std::span<const float> weights;
    if (deformation.morphed) weights = pose_.node_weights[n];
    std::span<const glm::dmat4> joints;
    if (deformation.skinned) joints = skin(scene_.nodes[n].skin).target_from_bind;
    return deformed_bounds(section, *deformation.bounds, joints, weights, target_from_local);
  }

 private:
  // Weights that are zero and that no animation drives leave the vertices as they are. Animated ones count even at
  // zero, so that the frames of a sequence keep one plan.
  bool weights_matter(size_t n) const {
    if (weights_animated_[n]) return true;
    for (float w : pose_.node_weights[n])
      if (w != 0) return true;
    return false;
  }

  void find_animated_weights() {
    weights_animated_.assign(scene_.nodes.size(), false);
    for (const Animation& animation : scene_.animations)
      for (const AnimationChannel& channel : animation.channels)
        if (channel.path == TargetPath::node_weights && channel.object >= 0 &&
            size_t(channel.object) < scene_.nodes.size())
          weights_animated_[size_t(channel.object)] = true;
  }

  const Scene& scene_;
  const Pose& pose_;
  glm::dmat4 target_from_world_;
  std::vector<SkinMatrices> skins_;
  std::vector<bool> weights_animated_;
};

Aabb to_float(const DAabb& box) {
  if (!is_finite(box)) {
    const glm::vec3 infinity(std::numeric_limits<float>::infinity());
    return {-infinity, infinity};
  }
  return {glm::vec3(box.min), glm::vec3(box.max)};
}

class FrameBuilder {
 public:
  FrameBuilder(const Scene& scene, const Pose& pose, const View& view)
      : scene_(scene), pose_(pose), view_(view), drawn_(scene, pose, relative_from_world(view.position)) {
    frame_.perspective = view.perspective;
    reserve();
  }

  FrameData build() {
    for (int n : scene_.order) add_node(size_t(n));
    return std::move(frame_);
  }

 private:
  void reserve() {
    size_t transforms = 0, items = 0, lights = 0;
    for (int n : scene_.order) {
      const Node& node = scene_.nodes[size_t(n)];
      lights += node.light >= 0;
      if (!drawn_.visible(node, size_t(n))) continue;
      transforms += instance_count(node) + 1;
      items += instance_count(node) * scene_.meshes[size_t(node.mesh)].sections.size();
    }
    frame_.relative_from_local.reserve(transforms);
    frame_.items.reserve(items);
    frame_.lights.reserve(lights);
  }

  void add_node(size_t n) {
    const Node& node = scene_.nodes[n];
    if (!pose_.node_visible[n]) return;
    if (node.light >= 0) add_light(node, n);
    if (node.mesh < 0) return;
    const std::vector<MeshSection>& sections = scene_.meshes[size_t(node.mesh)].sections;
    deformations_.clear();
    deformations_.resize(sections.size());
    indices_.assign(sections.size(), -1);
    morph_first_ = -1;
    bool any_skinned = false, any_rigid = false;
    for (size_t s = 0; s < sections.size(); ++s) {
      if (!can_be_drawn(sections[s])) continue;
      drawn_.deformation_of(sections[s], n, deformations_[s]);
      (deformations_[s].skinned ? any_skinned : any_rigid) = true;
      if (deformations_[s]) indices_[s] = add_deformation(node, n, uint32_t(s), deformations_[s]);
    }
    if (any_skinned) add_skinned(node, n, sections);
    if (any_rigid) add_rigid(node, n, sections);
  }

  // Skinned vertices come out in relative space: the node's transform and its instancing do not apply.
  void add_skinned(const Node& node, size_t n, const std::vector<MeshSection>& sections) {
    const uint32_t transform = add_transform(glm::dmat4(1.0));
    const bool mirrored = drawn_.skin(node.skin).mirrored;
    for (size_t s = 0; s < sections.size(); ++s)
      if (can_be_drawn(sections[s]) && deformations_[s].skinned)
        add_item(n, s, 0, transform, glm::dmat4(1.0), mirrored);
  }

  void add_rigid(const Node& node, size_t n, const std::vector<MeshSection>& sections) {
    const glm::dmat4 relative_from_node = drawn_.target_from_node(n);
    for (size_t i = 0; i < instance_count(node); ++i) {
      const glm::dmat4 m =
          node.instances ? relative_from_node * instance_transform(*node.instances, i) : relative_from_node;
      const uint32_t transform = add_transform(m);
      const bool mirrored = glm::determinant(glm::dmat3(m)) < 0;
      for (size_t s = 0; s < sections.size(); ++s)
        if (can_be_drawn(sections[s]) && !deformations_[s].skinned) add_item(n, s, i, transform, m, mirrored);
    }
  }

  uint32_t add_transform(const glm::dmat4& m) {
    frame_.relative_from_local.push_back(glm::mat4(m));
    return uint32_t(frame_.relative_from_local.size() - 1);
  }

  void add_item(size_t n, size_t s, size_t instance, uint32_t transform, const glm::dmat4& relative_from_local,
                bool mirrored) {
    const uint32_t mesh = uint32_t(scene_.nodes[n].mesh);
    const MeshSection& section = scene_.meshes[mesh].sections[s];
    const DAabb bounds = drawn_.bounds_of(section, n, deformations_[s], relative_from_local);
    DrawItem item;
    item.mesh = mesh;
    item.section = uint32_t(s);
    item.node = uint32_t(n);
    item.instance = uint32_t(instance);
    item.transform = transform;
    item.material = section.material;
    item.mirrored = mirrored;
    item.deformed = indices_[s];
    item.bounds_relative = to_float(bounds);
    if (is_finite(bounds)) item.view_depth_m = -(view_.view_from_relative * glm::dvec4(bounds.centre(), 1.0)).z;
    frame_.items.push_back(item);
  }

  int add_deformation(const Node& node, size_t n, uint32_t section, const SectionDeformation& how) {
    Deformation deformation;
    deformation.mesh = uint32_t(node.mesh);
    deformation.section = section;
    if (how.skinned) {
      SkinMatrices& skin = drawn_.skin(node.skin);
      if (skin.first < 0) {
        skin.first = int(frame_.joint_matrices.size());
        for (const glm::dmat4& m : skin.target_from_bind) frame_.joint_matrices.push_back(glm::mat4(m));
      }
      deformation.first_joint = uint32_t(skin.first);
      deformation.joint_count = uint32_t(skin.target_from_bind.size());
    }
    if (how.morphed) {
      const std::vector<float>& weights = pose_.node_weights[n];
      if (morph_first_ < 0) {
        morph_first_ = int(frame_.morph_weights.size());
        frame_.morph_weights.insert(frame_.morph_weights.end(), weights.begin(), weights.end());
      }
      deformation.first_weight = uint32_t(morph_first_);
      const size_t targets = scene_.meshes[size_t(node.mesh)].sections[section].morph.size();
      deformation.weight_count = uint32_t(std::min(weights.size(), targets));
    }
    frame_.deformations.push_back(deformation);
    return int(frame_.deformations.size() - 1);
  }

  void add_light(const Node& node, size_t n) {
    const Light& light = pose_.lights[size_t(node.light)];
    const glm::vec3 intensity = light.color * light.intensity;
    const glm::dmat4& world = pose_.world_from_node[n];
    const glm::vec3 position(glm::dvec3(world[3]) - view_.position);
    const auto finite = [](glm::vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
    if (!finite(intensity) || !finite(position) || intensity == glm::vec3(0)) return;
    LightItem item{light.type};
    item.position = position;
    item.direction = shining_direction(world);
    item.intensity = intensity;
    item.range_m = light.range_m;
    item.inner_cone_rad = light.inner_cone_rad;
    item.outer_cone_rad = light.outer_cone_rad;
    item.node = uint32_t(n);
    frame_.lights.push_back(item);
  }

  // Along the node's -Z whatever its scale; an axis scaled to nothing is rebuilt from the other two.
  static glm::vec3 shining_direction(const glm::dmat4& world) {
    glm::dvec3 back(world[2]);
    if (!(glm::length(back) > 0)) back = glm::cross(glm::dvec3(world[0]), glm::dvec3(world[1]));
    const double length = glm::length(back);
    return length > 0 && std::isfinite(length) ? glm::vec3(-back / length) : glm::vec3(0, 0, -1);
  }

  const Scene& scene_;
  const Pose& pose_;
  const View& view_;
  DrawnSections drawn_;
  FrameData frame_;
  // Of the node at hand, kept to save allocations.
  std::vector<SectionDeformation> deformations_;
  std::vector<int> indices_;  // into FrameData::deformations
  int morph_first_ = -1;
};

}  // namespace

DAabb world_bounds(const Scene& scene, const Pose& pose) {
  DrawnSections drawn(scene, pose, glm::dmat4(1.0));
  DAabb result;
  const auto add = [&](const DAabb& box) {
    if (is_finite(box)) result.add(box);  // what cannot be bounded would leave nothing to frame
  };
  for (int node_index : scene.order) {
    const size_t n = size_t(node_index);
    const Node& node = scene.nodes[n];
    if (!drawn.visible(node, n)) continue;
    const glm::dmat4 world_from_node = drawn.target_from_node(n);
    for (const MeshSection& section : scene.meshes[size_t(node.mesh)].sections) {
      if (!can_be_drawn(section)) continue;
      SectionDeformation deformation;
      drawn.deformation_of(section, n, deformation);
      if (deformation.skinned || !node.instances) {
        add(drawn.bounds_of(section, n, deformation, world_from_node));
        continue;
      }
      for (size_t i = 0; i < node.instances->count; ++i)
        add(drawn.bounds_of(section, n, deformation, world_from_node * instance_transform(*node.instances, i)));
    }
  }
  return result;
}

FrameData make_frame_data(const Scene& scene, const Pose& pose, const View& view) {
  return FrameBuilder(scene, pose, view).build();
}

}  // namespace candela
