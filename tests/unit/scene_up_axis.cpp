#include "scene/up_axis.h"

#include <gtest/gtest.h>

#include "scene/pose.h"

namespace candela {
namespace {

// A node at (1, 2, 3) under a root that an animation could move, and a root of its own.
Scene three_nodes() {
  Scene scene;
  scene.nodes.resize(3);
  scene.nodes[0].children = {1};
  scene.nodes[1].parent = 0;
  scene.nodes[1].translation = {1, 2, 3};
  scene.nodes[2].translation = {0, 0, 7};
  scene.roots = {0, 2};
  scene.order = {0, 1, 2};
  return scene;
}

TEST(UpAxis, BecomesYAndTheWorldStaysRightHanded) {
  EXPECT_EQ(up_axes(), (std::vector<std::string>{"x", "y", "z"}));
  const glm::dvec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (size_t i = 0; i < 3; ++i) {
    const glm::dmat3 turned = world_from_file(up_axes()[i]);
    EXPECT_EQ(turned * axes[i], glm::dvec3(0, 1, 0)) << up_axes()[i];
    EXPECT_EQ(glm::determinant(turned), 1) << up_axes()[i];
  }
  EXPECT_EQ(world_from_file("z") * glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1)) << "the front";
}

TEST(UpAxis, TurnsAllThatASceneHolds) {
  for (const std::string& up : up_axes()) {
    Scene scene = three_nodes();
    const Pose before = evaluate_pose(scene, {}, 0);
    turn_up(scene, up);
    const Pose after = evaluate_pose(scene, {}, 0);
    const glm::dmat4 turned(world_from_file(up));
    for (size_t n = 0; n < 3; ++n) EXPECT_EQ(after.world_from_node[n], turned * before.world_from_node[n]) << up << n;
    EXPECT_EQ(scene.nodes.size(), up == "y" ? 3u : 4u);
  }
}

}  // namespace
}  // namespace candela
