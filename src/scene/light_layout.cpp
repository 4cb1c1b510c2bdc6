#include "scene/light_layout.h"

#include <algorithm>
#include <cmath>

#include "math/bounds.h"
#include "scene/spatial_order.h"

namespace candela {
namespace {

constexpr uint32_t cluster_size = 32;

LightCluster cluster_of(const LightSet& set, uint32_t first, uint32_t count) {
  const auto members = std::span(set.places).subspan(first, count);
  Aabb box;
  for (const glm::vec4& place : members) box.add(glm::vec3(place));
  LightCluster cluster{box.centre(), 0, 0, first, count};
  double radius = 0;
  for (const glm::vec4& place : members) {
    radius = std::max(radius, glm::distance(glm::dvec3(place), glm::dvec3(cluster.centre)));
    cluster.range_m = std::max(cluster.range_m, place.w);
  }
  cluster.radius_m = std::nextafter(float(radius), std::numeric_limits<float>::infinity());
  return cluster;
}

void add_clusters(const LightInstances& instances, LightSet& set) {
  const std::vector<uint32_t> order = spatial_order(instances.translation);
  set.places.reserve(order.size());
  for (const uint32_t i : order)
    set.places.emplace_back(instances.translation[i], instances.range_m.empty() ? 0 : instances.range_m[i]);
  for (uint32_t first = 0; first < order.size(); first += cluster_size)
    set.clusters.push_back(cluster_of(set, first, std::min(cluster_size, uint32_t(order.size()) - first)));
}

LightSet set_of(const LightInstances& instances) {
  LightSet set;
  set.count = uint32_t(instances.count());
  set.darkest = std::numeric_limits<double>::infinity(), set.brightest = 0;
  double farthest = 0;
  for (size_t i = 0; i < instances.count(); ++i) {
    farthest = std::max(farthest, glm::length(glm::dvec3(instances.translation[i])));
    const glm::vec3 color = instances.color.empty() ? glm::vec3(1) : instances.color[i];
    const double full = double(std::max({color.x, color.y, color.z})) *
                        (instances.intensity.empty() ? 1.0 : double(instances.intensity[i]));
    const double left = instances.modulation.empty() ? 1.0 : 1.0 - double(instances.modulation[i].depth);
    set.darkest = std::min(set.darkest, full * left);
    set.brightest = std::max(set.brightest, full);
  }
  set.farthest_m = std::nextafter(float(farthest), std::numeric_limits<float>::infinity());
  return set;
}

}  // namespace

LightLayout layout_lights(const Scene& scene) {
  LightLayout layout;
  layout.set_of_node.assign(scene.nodes.size(), -1);
  for (const int n : scene.order) {
    const auto& instances = scene.nodes[size_t(n)].light_instances;
    if (!instances || instances->count() == 0) continue;
    LightSet set = set_of(*instances);
    if (!(set.darkest > 0)) continue;
    set.node = uint32_t(n);
    set.first = layout.instance_count;
    add_clusters(*instances, set);
    layout.instance_count += set.count;
    layout.set_of_node[size_t(n)] = int(layout.sets.size());
    layout.sets.push_back(std::move(set));
  }
  return layout;
}

}  // namespace candela
