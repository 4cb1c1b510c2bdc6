#include "job/choose_occlusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "scene/moving_nodes.h"
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

// Whether an animation of the scene or a path moves what is drawn, and not cameras, lights or materials alone.
bool surfaces_move(const Scene& scene, bool animated) {
  AnimationChoice all;
  for (size_t a = 0; animated && a < scene.animations.size(); ++a) all.animations.push_back(int(a));
  const std::vector<bool> moving = moving_nodes(scene, all);
  return std::ranges::any_of(scene.order, [&](int n) { return scene.nodes[size_t(n)].mesh >= 0 && moving[size_t(n)]; });
}

}  // namespace

ChosenOcclusion choose_occlusion(const Scene& scene, const std::string& animation) {
  const uint64_t count = triangles(scene);
  const bool moves = surfaces_move(scene, animation != "none");
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
