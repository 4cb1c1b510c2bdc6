#include "scene/moving_nodes.h"

#include <algorithm>

#include "scene/scene_path.h"

namespace candela {

std::vector<bool> moving_nodes(const Scene& scene, const AnimationChoice& choice) {
  std::vector<bool> moving(scene.nodes.size());
  for (const int a : choice.animations)
    for (const AnimationChannel& channel : scene.animations[size_t(a)].channels)
      if (channel.path <= TargetPath::node_visible && channel.object >= 0)
        moving[size_t(channel.object)] = true;
      else if (channel.path >= TargetPath::metaballs_threshold)
        moving[size_t(scene.metaballs[size_t(channel.object)].node)] = true;
  if (scene.paths)
    for (const ScenePath& path : scene.paths->paths) moving[size_t(path.node)] = true;
  // `order` has parents first.
  for (const int n : scene.order) {
    const int parent = scene.nodes[size_t(n)].parent;
    if (parent >= 0 && moving[size_t(parent)]) moving[size_t(n)] = true;
  }
  const std::vector<bool> placed = moving;
  for (const int n : scene.order)
    if (const int skin = scene.nodes[size_t(n)].skin; skin >= 0)
      if (std::ranges::any_of(scene.skins[size_t(skin)].joints, [&](int joint) { return placed[size_t(joint)]; }))
        moving[size_t(n)] = true;
  for (const Metaballs& body : scene.metaballs)
    if (std::ranges::any_of(body.balls, [&](const Metaball& ball) { return placed[size_t(ball.node)]; }))
      moving[size_t(body.node)] = true;
  return moving;
}

}  // namespace candela
