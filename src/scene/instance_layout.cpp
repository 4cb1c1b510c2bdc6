#include "scene/instance_layout.h"

#include <algorithm>
#include <cmath>

#include "scene/drawn_sections.h"
#include "scene/spatial_order.h"

namespace candela {
namespace {

constexpr uint32_t instances_a_cluster = 32;
constexpr double farthest_m = 1e15;

bool is_near(const glm::dmat4& m) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row)
      if (!(std::abs(m[column][row]) < farthest_m)) return false;
  return true;
}

// Sections of the node's mesh that can be drawn; none where some are deformed.
std::vector<uint32_t> rigid_sections(const Scene& scene, const Node& node) {
  std::vector<uint32_t> sections;
  if (node.skin >= 0) return sections;
  const Mesh& mesh = scene.meshes[size_t(node.mesh)];
  for (uint32_t s = 0; s < mesh.sections.size(); ++s) {
    if (!mesh.sections[s].morph.empty()) return {};
    if (DrawnSections::can_be_drawn(mesh.sections[s])) sections.push_back(s);
  }
  return sections;
}

void add(InstanceCluster& cluster, const DAabb& mesh_box, const glm::dmat4& m) {
  cluster.box.add(transformed(mesh_box, m));
  const glm::dvec3 reach = glm::max(glm::abs(mesh_box.min), glm::abs(mesh_box.max));
  glm::dvec3 magnitude = glm::abs(glm::dvec3(m[3]));
  for (int i = 0; i < 3; ++i) magnitude += glm::abs(glm::dvec3(m[i])) * reach[i];
  cluster.magnitude = glm::max(cluster.magnitude, magnitude);
}

bool all_surely(const DAabb& mesh_box, InstanceSet& set) {
  for (const glm::dmat4& m : set.node_from_instance) {
    if (!is_near(m) || !turns_surely(m)) return false;
    const bool turned = glm::determinant(glm::dmat3(m)) < 0;
    if (&m == &set.node_from_instance.front()) set.mirrored = turned;
    if (turned != set.mirrored) return false;
    const DAabb box = transformed(mesh_box, m);
    for (int axis = 0; axis < 3; ++axis)
      if (!(box.min[axis] > -farthest_m && box.max[axis] < farthest_m)) return false;
  }
  return true;
}

void add_clusters(const DAabb& mesh_box, InstanceSet& set) {
  std::vector<glm::vec3> places;
  for (const glm::dmat4& m : set.node_from_instance) places.emplace_back(m[3]);
  set.order = spatial_order(places);
  for (uint32_t first = 0; first < set.count; first += instances_a_cluster) {
    InstanceCluster cluster{{}, glm::dvec3(0), first, std::min(instances_a_cluster, set.count - first)};
    for (uint32_t i = first; i < first + cluster.count; ++i)
      add(cluster, mesh_box, set.node_from_instance[set.order[i]]);
    set.all.box.add(cluster.box);
    set.all.magnitude = glm::max(set.all.magnitude, cluster.magnitude);
    set.clusters.push_back(cluster);
  }
}

}  // namespace

// A product's rounding is some units in the last place of the product of its columns' lengths; each of two factors may
// lose six digits of that.
bool turns_surely(const glm::dmat4& m) {
  const double size = glm::length(glm::dvec3(m[0])) + glm::length(glm::dvec3(m[1])) + glm::length(glm::dvec3(m[2]));
  const double volume = std::abs(glm::determinant(glm::dmat3(m)));
  return volume > 1e-6 * size * size * size && volume > 1e-30;
}

InstanceLayout layout_instances(const Scene& scene) {
  InstanceLayout layout;
  layout.set_of_node.assign(scene.nodes.size(), -1);
  for (const int n : scene.order) {
    const Node& node = scene.nodes[size_t(n)];
    if (node.mesh < 0 || !node.instances || node.instances->count == 0) continue;
    InstanceSet set;
    set.sections = rigid_sections(scene, node);
    DAabb mesh_box;
    for (const uint32_t s : set.sections) {
      const Aabb& box = scene.meshes[size_t(node.mesh)].sections[s].bounds;
      mesh_box.add(DAabb{glm::dvec3(box.min), glm::dvec3(box.max)});
    }
    if (set.sections.empty()) continue;
    set.node = uint32_t(n);
    set.first = layout.instance_count;
    set.count = uint32_t(node.instances->count);
    for (uint32_t i = 0; i < set.count; ++i) set.node_from_instance.push_back(node_from_instance(*node.instances, i));
    if (!all_surely(mesh_box, set)) continue;
    add_clusters(mesh_box, set);
    layout.instance_count += set.count;
    layout.set_of_node[size_t(n)] = int(layout.sets.size());
    layout.sets.push_back(std::move(set));
  }
  return layout;
}

}  // namespace candela
