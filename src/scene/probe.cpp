#include "scene/probe.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.h"

namespace candela {
namespace {

constexpr int rings = 48, segments = 96;
constexpr double share_of_height = 0.25;
constexpr double distance_m = 0.5, share_of_scene = 0.1;

MeshSection unit_sphere(int material) {
  MeshSection s;
  s.place = "--probe";
  s.material = material;
  for (int ring = 0; ring <= rings; ++ring)
    for (int segment = 0; segment <= segments; ++segment) {
      const double polar = std::numbers::pi * ring / rings, longitude = 2 * std::numbers::pi * segment / segments;
      const glm::vec3 p(std::sin(polar) * std::cos(longitude), std::cos(polar), -std::sin(polar) * std::sin(longitude));
      s.position.push_back(p);
      s.normal.push_back(glm::normalize(p));
    }
  const auto vertex = [](int ring, int segment) { return uint32_t(ring * (segments + 1) + segment); };
  for (int ring = 0; ring < rings; ++ring)
    for (int segment = 0; segment < segments; ++segment) {
      const uint32_t a = vertex(ring, segment), b = vertex(ring + 1, segment), c = vertex(ring + 1, segment + 1),
                     d = vertex(ring, segment + 1);
      if (ring > 0) s.index.insert(s.index.end(), {a, c, d});
      if (ring + 1 < rings) s.index.insert(s.index.end(), {a, b, c});
    }
  s.bounds = {glm::vec3(-1), glm::vec3(1)};
  return s;
}

Material probe_material(Probe probe) {
  Material m;
  m.name = "probe";
  m.metallic = probe == Probe::chrome ? 1 : 0;
  m.roughness = probe == Probe::chrome ? 0 : 1;
  m.specular = probe == Probe::chrome ? 1 : 0;
  m.base_color = glm::vec4(glm::vec3(probe == Probe::white ? 0.9f : probe == Probe::grey ? 0.18f : 1.0f), 1);
  return m;
}

}  // namespace

std::vector<std::string> probe_names() { return {"white", "grey", "chrome"}; }
Probe probe_from_name(const std::string& name) {
  return name == "white" ? Probe::white : name == "grey" ? Probe::grey : name == "chrome" ? Probe::chrome : Probe::none;
}

void add_probe(Scene& scene, Probe probe) {
  if (probe == Probe::none) return;
  scene.materials.push_back(probe_material(probe));
  scene.meshes.push_back({"probe", {unit_sphere(int(scene.materials.size()) - 1)}, {}});
  Node node;
  node.name = "probe";
  node.mesh = int(scene.meshes.size()) - 1;
  node.visible = false;
  scene.probe_node = int(scene.nodes.size());
  scene.nodes.push_back(std::move(node));
  scene.roots.push_back(scene.probe_node);
  scene.order.push_back(scene.probe_node);
}

void place_probe(const Scene& scene, Pose& pose, const View& view, const DrawnBounds& bounds) {
  if (scene.probe_node < 0) return;
  const DAabb& box = bounds.box();
  const double size = box.empty() ? 0 : 2 * glm::length(box.extent());
  double distance = size > 0 && std::isfinite(size) ? std::min(distance_m, share_of_scene * size) : distance_m;
  // The sphere's near side is at three quarters of the distance or more while its half angle is below 45 degrees.
  distance = std::max(distance, 4 * view.near_m);
  const double radius =
      view.perspective ? distance * std::sin(std::atan(share_of_height * view.tan_y)) : share_of_height * view.tan_y;
  if (!view.perspective) distance = std::max(distance, view.near_m + 2 * radius);
  const glm::dmat3 world_from_view = glm::transpose(glm::dmat3(view.view_from_relative));
  const glm::dvec3 place = view.position - world_from_view[2] * distance;
  glm::dmat4& world = pose.world_from_node[size_t(scene.probe_node)];
  world = glm::dmat4(world_from_view * radius);
  world[3] = glm::dvec4(place, 1);
  pose.node_visible[size_t(scene.probe_node)] = true;
}

}  // namespace candela
