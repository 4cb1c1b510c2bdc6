#include "scene/up_axis.h"

namespace candela {

std::vector<std::string> up_axes() { return {"x", "y", "z"}; }

glm::dmat3 world_from_file(const std::string& up) {
  if (up == "z") return {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
  if (up == "x") return {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}};
  return glm::dmat3(1);
}

void turn_up(Scene& scene, const std::string& up) {
  if (up == "y") return;
  const int turned = int(scene.nodes.size());
  for (const int root : scene.roots) scene.nodes[size_t(root)].parent = turned;
  Node node{.name = "up"};
  node.children = scene.roots;
  node.has_matrix = true, node.matrix = glm::dmat4(world_from_file(up));
  scene.nodes.push_back(std::move(node));
  scene.roots = {turned};
  scene.order.insert(scene.order.begin(), turned);
}

}  // namespace candela
