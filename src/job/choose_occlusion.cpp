#include "job/choose_occlusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "scene/sum_over_instances.h"

namespace candela {
namespace {

// Triangles of all instances, about a second's building by two cores; and of frames that build trees each.
constexpr uint64_t most_still = 2'000'000, most_moving = 20'000;

uint64_t triangles(const Scene& scene) {
  return sum_over_instances(scene, [](const MeshSection& section) -> uint64_t {
    return section.topology == Topology::triangles ? section.index.size() / 3 : 0;
  });
}

bool moves_nodes(TargetPath path) { return path <= TargetPath::node_visible; }

// Whether an animation of the scene moves what is drawn, and not cameras, lights or materials alone.
bool surfaces_move(const Scene& scene) {
  std::vector<bool> moved(scene.nodes.size());
  for (const Animation& animation : scene.animations)
    for (const AnimationChannel& channel : animation.channels)
      if (moves_nodes(channel.path) && channel.object >= 0) moved[size_t(channel.object)] = true;
  // `order` has parents first.
  for (const int n : scene.order) {
    const int parent = scene.nodes[size_t(n)].parent;
    if (parent >= 0 && moved[size_t(parent)]) moved[size_t(n)] = true;
  }
  const auto is_moved = [&](int node) { return moved[size_t(node)]; };
  return std::ranges::any_of(scene.order,
                             [&](int n) { return scene.nodes[size_t(n)].mesh >= 0 && moved[size_t(n)]; }) ||
         std::ranges::any_of(scene.skins, [&](const Skin& s) { return std::ranges::any_of(s.joints, is_moved); });
}

}  // namespace

ChosenOcclusion choose_occlusion(const Scene& scene, const std::string& animation) {
  const uint64_t count = triangles(scene);
  const bool moves = animation != "none" && surfaces_move(scene);
  const auto is_field = [](const Node& n) { return n.mesh >= 0 && n.instances != nullptr; };
  const bool fields =
      std::ranges::any_of(scene.nodes, is_field);  // the device may pose them, and trees need the host's
  const uint64_t most = moves || fields ? most_moving : most_still;
  if (count <= most) return {OcclusionKnobs::by_rays, fmt::format("{} triangles are few enough for trees", count)};
  return {OcclusionKnobs::screen, fmt::format("trees over {} triangles{} would cost more than they give", count,
                                              moves    ? ", made anew for each frame, for the scene moves,"
                                              : fields ? " of instances"
                                                       : "")};
}

}  // namespace candela
