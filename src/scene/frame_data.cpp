#include "scene/frame_data.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "math/transforms.h"
#include "scene/drawn_sections.h"
#include "scene/light_instances.h"
#include "scene/posed_parts.h"

namespace candela {
namespace {

Aabb to_float(const DAabb& box) {
  if (!is_finite(box)) {
    const glm::vec3 infinity(std::numeric_limits<float>::infinity());
    return {-infinity, infinity};
  }
  return {glm::vec3(box.min), glm::vec3(box.max)};
}

// As new, but for the lists' memory.
void clear(FrameData& data) {
  const auto empty = [](auto&... lists) { (lists.clear(), ...); };
  empty(data.relative_from_local, data.world_origins, data.items, data.item_groups, data.deformations,
        data.joint_matrices, data.morph_weights, data.metaballs, data.lights, data.light_groups);
  data.first_sun.reset();
  data.perspective = true;
  // A list that is not named above would keep the last frame's.
  static_assert(sizeof(FrameData) == 10 * sizeof(std::vector<int>) + sizeof(data.first_sun) + 8);
}

class FrameBuilder {
 public:
  FrameBuilder(const Scene& scene, const Pose& pose, const View& view, double lamp_radius_m,
               const DevicePose& on_device, double cells, FrameData& frame)
      : scene_(scene),
        pose_(pose),
        view_(view),
        drawn_(scene, pose, relative_from_world(view.position)),
        lamp_radius_m_(float(lamp_radius_m)),
        on_device_(on_device),
        cells_(cells),
        frame_(frame) {
    clear(frame_);
    frame_.perspective = view.perspective;
  }

  void build() {
    for (int n : scene_.order) add_node(size_t(n));
  }

 private:
  void add_node(size_t n) {
    const Node& node = scene_.nodes[n];
    if (!pose_.node_visible[n]) return;
    if (node.light >= 0) add_light(node, n);
    if (node.light_instances) add_light_instances(*node.light_instances, n);
    if (node.mesh < 0) return;
    if (const auto group = group_of(n)) {
      frame_.item_groups.push_back(*group);
      frame_.item_groups.back().before = uint32_t(frame_.items.size());
      return;
    }
    const std::vector<MeshSection>& sections = scene_.meshes[size_t(node.mesh)].sections;
    if (!sections.empty() && sections[0].metaballs >= 0) return add_metaballs(n, sections[0]);
    deformations_.clear();
    deformations_.resize(sections.size());
    indices_.assign(sections.size(), -1);
    morph_first_ = -1;
    bool any_skinned = false, any_rigid = false;
    for (size_t s = 0; s < sections.size(); ++s) {
      if (!DrawnSections::can_be_drawn(sections[s])) continue;
      deformations_[s] = drawn_.deformation_of(sections[s], n);
      (deformations_[s].skinned ? any_skinned : any_rigid) = true;
      if (deformations_[s]) indices_[s] = add_deformation(node, n, uint32_t(s), deformations_[s]);
    }
    if (any_skinned) add_skinned(node, n, sections);
    if (any_rigid) add_rigid(n, sections);
  }

  // Where a pass can pose the node's instances: all are drawn in any order, and lie where their boxes are finite.
  std::optional<ItemGroup> group_of(size_t n) const {
    if (!on_device_.instances || on_device_.instances->set_of_node[n] < 0) return std::nullopt;
    const InstanceSet& set = on_device_.instances->sets[size_t(on_device_.instances->set_of_node[n])];
    const uint32_t mesh = uint32_t(scene_.nodes[n].mesh);
    for (const uint32_t s : set.sections) {
      const int material = scene_.meshes[mesh].sections[s].material;
      if (material < 0) continue;
      const Material& m = pose_.materials[size_t(material)];
      if (m.alpha_mode == AlphaMode::blend || m.has(Lobe::transmission)) return std::nullopt;
    }
    ItemGroup group{
        &set, 0, uint32_t(n), mesh, set.mirrored, drawn_.target_from_node(n), glm::dvec3(pose_.world_from_node[n][3])};
    if (!turns_surely(group.relative_from_node)) return std::nullopt;
    if (glm::determinant(glm::dmat3(group.relative_from_node)) < 0) group.mirrored = !group.mirrored;
    const DAabb box = relative_box(group, set.all);
    for (int axis = 0; axis < 3; ++axis)
      if (!(box.min[axis] > -1e15 && box.max[axis] < 1e15)) return std::nullopt;
    return group;
  }

  // Skinned vertices come out in relative space: the node's transform and its instancing do not apply.
  void add_skinned(const Node& node, size_t n, const std::vector<MeshSection>& sections) {
    const uint32_t transform = uint32_t(frame_.relative_from_local.size());
    frame_.relative_from_local.push_back(glm::mat4(1.0f));
    frame_.world_origins.push_back(view_.position);
    const bool mirrored = drawn_.skin(node.skin).mirrored;
    for (size_t s = 0; s < sections.size(); ++s)
      if (DrawnSections::can_be_drawn(sections[s]) && deformations_[s].skinned)
        frame_.items.push_back(item_of(n, s, 0, transform, glm::dmat4(1.0), mirrored));
  }

  // One transform, whether there is a surface or not, so that motion finds the same ones at the time before.
  void add_metaballs(size_t n, const MeshSection& section) {
    const Metaballs& body = pose_.metaballs[size_t(section.metaballs)];
    PosedMetaballs posed;
    posed.index = uint32_t(section.metaballs), posed.node = uint32_t(n), posed.mesh = uint32_t(scene_.nodes[n].mesh);
    posed.relative_from_node = drawn_.target_from_node(n);
    posed.threshold = body.threshold;
    posed.noise_amplitude = body.noise_amplitude, posed.noise_frequency_per_m = body.noise_frequency_per_m;
    posed.balls = pose_metaballs(body, pose_);
    posed.lattice = make_metaball_lattice(posed.balls, posed.threshold, double(body.cell_m) * cells_);
    posed.transform = uint32_t(frame_.relative_from_local.size());
    posed.first_deformation = uint32_t(frame_.deformations.size());
    posed.chunks = metaball_chunks(posed.lattice.most_triangles);
    const glm::dvec3 origin_m = posed.lattice.origin_m();
    const glm::dmat4 relative_from_lattice = posed.relative_from_node * glm::translate(glm::dmat4(1.0), origin_m);
    frame_.relative_from_local.push_back(glm::mat4(relative_from_lattice));
    frame_.world_origins.push_back(glm::dvec3(pose_.world_from_node[n] * glm::dvec4(origin_m, 1.0)));
    DrawItem item;
    item.mesh = posed.mesh, item.node = posed.node, item.transform = posed.transform;
    item.material = section.material;
    item.mirrored = glm::determinant(glm::dmat3(posed.relative_from_node)) < 0;
    const DAabb bounds = drawn_metaball_bounds(posed.balls, posed.threshold, posed.lattice.cell_m);
    const DAabb relative = bounds.empty() ? bounds : padded_bounds(bounds, posed.relative_from_node);
    item.bounds_relative = to_float(relative);
    if (is_finite(relative)) item.view_depth_m = -(view_.view_from_relative * glm::dvec4(relative.centre(), 1.0)).z;
    for (uint32_t chunk = 0; chunk < posed.chunks; ++chunk) {
      item.deformed = int(frame_.deformations.size());
      Deformation deformation{.mesh = posed.mesh, .section = 0};
      deformation.body = int(frame_.metaballs.size()), deformation.chunk = chunk;
      frame_.deformations.push_back(deformation);
      frame_.items.push_back(item);
    }
    frame_.metaballs.push_back(std::move(posed));
  }

  // Instances are many: each thread takes some, to their places.
  void add_rigid(size_t n, const std::vector<MeshSection>& sections) {
    std::vector<size_t>& rigid = rigid_;
    rigid.clear();
    for (size_t s = 0; s < sections.size(); ++s)
      if (DrawnSections::can_be_drawn(sections[s]) && !deformations_[s].skinned) rigid.push_back(s);
    const size_t count = drawn_.instance_count(n), first_transform = frame_.relative_from_local.size(),
                 first_item = frame_.items.size();
    frame_.relative_from_local.resize(first_transform + count);
    frame_.world_origins.resize(first_transform + count);
    frame_.items.resize(first_item + count * rigid.size());
    const glm::dmat4 target_from_node = drawn_.target_from_node(n);
    const auto add = [&](const tbb::blocked_range<size_t>& range) {
      for (size_t i = range.begin(); i < range.end(); ++i) {
        const glm::dmat4 m = drawn_.target_from_instance(target_from_node, n, i);
        const size_t transform = first_transform + i;
        frame_.relative_from_local[transform] = glm::mat4(m);
        frame_.world_origins[transform] = glm::dvec3(drawn_.target_from_instance(pose_.world_from_node[n], n, i)[3]);
        const bool mirrored = glm::determinant(glm::dmat3(m)) < 0;
        for (size_t r = 0; r < rigid.size(); ++r)
          frame_.items[first_item + i * rigid.size() + r] = item_of(n, rigid[r], i, uint32_t(transform), m, mirrored);
      }
    };
    const tbb::blocked_range<size_t> all(0, count, 512);
    if (count <= all.grainsize())
      add(all);
    else
      tbb::parallel_for(all, add);
  }

  // A relief lies below its triangles, up to as far as its floor does.
  DAabb with_relief(DAabb bounds, const MeshSection& section, const glm::dmat3& linear) const {
    const size_t material = size_t(std::max(section.material, 0));
    if (section.material < 0 || material >= pose_.materials.size() || !pose_.materials[material].has_relief())
      return bounds;
    const double depth = pose_.materials[material].relief.depth;
    const glm::dvec3 reach = depth * (glm::abs(linear[0]) + glm::abs(linear[1]) + glm::abs(linear[2]));
    bounds.min -= reach, bounds.max += reach;
    return bounds;
  }

  DrawItem item_of(size_t n, size_t s, size_t instance, uint32_t transform, const glm::dmat4& relative_from_local,
                   bool mirrored) {
    const uint32_t mesh = uint32_t(scene_.nodes[n].mesh);
    const MeshSection& section = scene_.meshes[mesh].sections[s];
    const DAabb bounds = with_relief(drawn_.bounds_of(section, n, deformations_[s], relative_from_local), section,
                                     glm::dmat3(relative_from_local));
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
    return item;
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

  static bool all_finite(glm::vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

  // Lights that give nothing, and those that a broken transform left nowhere, are not listed.
  void add_light_item(const LightItem& item) {
    if (!all_finite(item.intensity) || !all_finite(item.position)) return;
    if (item.type == LightType::directional && !frame_.first_sun) frame_.first_sun = item;
    if (item.intensity != glm::vec3(0)) frame_.lights.push_back(item);
  }

  LightItem light_item(const Light& light, size_t n) const {
    LightItem item{light.type};
    item.intensity = light.color * light.intensity;
    item.range_m = light.range_m;
    item.inner_cone_rad = light.inner_cone_rad;
    item.outer_cone_rad = light.outer_cone_rad;
    item.node = uint32_t(n);
    if (light.type != LightType::directional) item.radius_m = light.radius_m.value_or(lamp_radius_m_);
    return item;
  }

  void add_light(const Node& node, size_t n) {
    const glm::dmat4& world = pose_.world_from_node[n];
    LightItem item = light_item(pose_.lights[size_t(node.light)], n);
    item.world_position = glm::dvec3(world[3]);
    item.position = glm::vec3(item.world_position - view_.position);
    item.direction = shining_direction(world);
    add_light_item(item);
  }

  void add_light_instances(const LightInstances& instances, size_t n) {
    const Light& light = pose_.lights[size_t(instances.light)];
    const glm::dmat4& world = pose_.world_from_node[n];
    const glm::dmat3 linear(world);
    const glm::dvec3 origin = glm::dvec3(world[3]) - view_.position;
    LightItem item = light_item(light, n);
    const glm::vec3 direction = shining_direction(world);
    if (on_device_.lights && on_device_.lights->set_of_node[n] >= 0) {
      item.direction = direction;
      const LightSet& set = on_device_.lights->sets[size_t(on_device_.lights->set_of_node[n])];
      const LightGroup group{&set,  uint32_t(frame_.lights.size()), item, light.color, double(light.intensity), origin,
                             linear};
      if (all_shine(group, instances)) {
        frame_.light_groups.push_back(group);
        return;
      }
    }
    for (size_t i = 0; i < instances.count(); ++i) {
      const glm::dvec3 from_node = linear * glm::dvec3(instances.translation[i]);
      item.world_position = glm::dvec3(world[3]) + from_node;
      item.position = glm::vec3(origin + from_node);
      item.direction = instances.direction.empty() ? direction : turned(linear, instances.direction[i], direction);
      double intensity = double(light.intensity);
      if (!instances.intensity.empty()) intensity *= double(instances.intensity[i]);
      if (!instances.modulation.empty()) intensity *= modulation_factor(instances.modulation[i], pose_.time_s);
      item.intensity = (instances.color.empty() ? light.color : light.color * instances.color[i]) * float(intensity);
      if (!instances.range_m.empty()) item.range_m = instances.range_m[i];
      add_light_item(item);
    }
  }

  // Whether each instance is a light of the frame for sure, has a range, and is no farther off than floats can square.
  static bool all_shine(const LightGroup& group, const LightInstances& instances) {
    const LightSet& set = *group.set;
    const double farthest = glm::length(group.origin) + frobenius(group.linear) * double(set.farthest_m);
    const double least = double(std::min({group.color.x, group.color.y, group.color.z})) * group.candela,
                 most = double(std::max({group.color.x, group.color.y, group.color.z})) * group.candela;
    return farthest < 1e15 && least * set.darkest > 1e-30 && most * set.brightest < 1e30 &&
           (!instances.range_m.empty() || std::isfinite(group.light.range_m));
  }

  // No less than what the matrix lengthens a vector by.
  static double frobenius(const glm::dmat3& m) {
    return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
  }

  // A direction of the node's space in relative space; where a scale of nothing swallows it, the node's own.
  static glm::vec3 turned(const glm::dmat3& linear, glm::vec3 direction, glm::vec3 otherwise) {
    const glm::dvec3 d = linear * glm::dvec3(direction);
    const double length = glm::length(d);
    return length > 0 && std::isfinite(length) ? glm::vec3(d / length) : otherwise;
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
  float lamp_radius_m_;
  const DevicePose& on_device_;
  double cells_;  // of metaballs, in units of what the scene says
  FrameData& frame_;
  // Of the node at hand, kept to save allocations.
  std::vector<SectionDeformation> deformations_;
  std::vector<int> indices_;  // into FrameData::deformations
  std::vector<size_t> rigid_;
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
    if (!drawn.has_visible_mesh(n)) continue;
    for (const MeshSection& section : scene.meshes[size_t(scene.nodes[n].mesh)].sections) {
      if (!DrawnSections::can_be_drawn(section)) continue;
      const SectionDeformation deformation = drawn.deformation_of(section, n);
      const size_t instances = deformation.skinned ? 1 : drawn.instance_count(n);
      const glm::dmat4 target_from_node = drawn.target_from_node(n);
      for (size_t i = 0; i < instances; ++i)
        add(drawn.bounds_of(section, n, deformation, drawn.target_from_instance(target_from_node, n, i)));
    }
  }
  return result;
}

size_t FrameData::light_count() const {
  size_t count = lights.size();
  for (const LightGroup& group : light_groups) count += group.set->count;
  return count;
}

size_t FrameData::item_count() const {
  size_t count = items.size();
  for (const ItemGroup& group : item_groups) count += group.item_count();
  return count;
}

// The items' own padding, and as much again for what their boxes and this one are rounded by.
DAabb relative_box(const ItemGroup& group, const InstanceCluster& cluster) {
  DAabb box = transformed(cluster.box, group.relative_from_node);
  glm::dvec3 magnitude = glm::abs(glm::dvec3(group.relative_from_node[3]));
  for (int i = 0; i < 3; ++i) magnitude += glm::abs(glm::dvec3(group.relative_from_node[i])) * cluster.magnitude[i];
  const glm::dvec3 pad = magnitude * 0x1p-19 + 1e-30;
  box.min -= pad, box.max += pad;
  return box;
}

Aabb bounds_of(const Scene& scene, const ItemGroup& group, uint32_t instance, uint32_t section) {
  const Aabb& box = scene.meshes[group.mesh].sections[section].bounds;
  return to_float(padded_bounds({glm::dvec3(box.min), glm::dvec3(box.max)},
                                group.relative_from_node * group.set->node_from_instance[instance]));
}

FrameData make_frame_data(const Scene& scene, const Pose& pose, const View& view, double lamp_radius_m,
                          const DevicePose& on_device, double cells) {
  FrameData data;
  fill_frame_data(scene, pose, view, lamp_radius_m, on_device, cells, data);
  return data;
}

void fill_frame_data(const Scene& scene, const Pose& pose, const View& view, double lamp_radius_m,
                     const DevicePose& on_device, double cells, FrameData& data) {
  FrameBuilder(scene, pose, view, lamp_radius_m, on_device, cells, data).build();
}

}  // namespace candela
