#include "scene/instance_layout.h"
#include "scene/largest_score.h"

#include <gtest/gtest.h>

#include "base/rng.h"
#include "scene/frame_data.h"

namespace candela {
namespace {

// A box of a mesh at many places, which one node shows.
struct Boxes {
  Scene scene;
  Instances instances;
  explicit Boxes(uint32_t count) {
    Rng rng(8);
    instances.count = count;
    for (uint32_t i = 0; i < count; ++i) {
      instances.translation.emplace_back(rng.uniform(-50, 50), rng.uniform(0, 5), rng.uniform(-50, 50));
      instances.scale.emplace_back(rng.uniform(0.5, 2), rng.uniform(0.5, 2), rng.uniform(0.5, 2));
    }
    MeshSection section;
    section.position = {{-1, 0, -1}, {2, 1, 0}, {0, 3, 1}};
    section.index = {0, 1, 2};
    section.material = 0;
    for (const glm::vec3& p : section.position) section.bounds.add(p);
    scene.meshes.push_back({"box", {section, section}, {}});
    scene.materials.emplace_back();
    scene.nodes.emplace_back();
    scene.nodes[0].mesh = 0;
    scene.nodes[0].translation = {3, 4, -60};
    scene.nodes[0].rotation = glm::normalize(glm::dquat(0.9, 0.1, 0.3, 0.2));
    scene.order = {0};
  }
  const Scene& made() {
    scene.nodes[0].instances = std::make_shared<const Instances>(instances);
    return scene;
  }
};

}  // namespace

// Whatever is asked for is what all items say, though few are looked at.
TEST(InstanceLayout, LargestScoresAreThoseOfAllItems) {
  Boxes node(1000);
  const InstanceLayout layout = layout_instances(node.made());
  ASSERT_EQ(layout.sets.size(), 1u);
  const Pose pose = evaluate_pose(node.scene, {}, 0);
  const FrameData items = make_frame_data(node.scene, pose, {}),
                  groups = make_frame_data(node.scene, pose, {}, 0, {nullptr, &layout});
  ASSERT_EQ(items.items.size(), 2000u);
  ASSERT_TRUE(groups.items.empty());
  EXPECT_EQ(groups.item_count(), 2000u);
  for (const glm::dvec3 way : {glm::dvec3(0, 0, -1), glm::dvec3(0.6, 0, 0.8), glm::dvec3(0, 1, 0)}) {
    size_t looked_at = 0;
    const auto depth = [&](const auto& box) {
      return glm::dot(glm::dvec3(box.centre()), way) + glm::dot(glm::dvec3(box.extent()), glm::abs(way));
    };
    double expected = -1e30;
    for (const DrawItem& item : items.items) expected = std::max(expected, depth(item.bounds_relative));
    const auto counted = [&](const Aabb& box) { return ++looked_at, depth(box); };
    EXPECT_EQ(largest_score(node.scene, groups, depth, counted), expected);
    EXPECT_LT(looked_at, 1000u);
  }
  for (const InstanceCluster& cluster : layout.sets[0].clusters) {
    const DAabb box = relative_box(groups.item_groups[0], cluster);
    for (uint32_t i = cluster.first; i < cluster.first + cluster.count; ++i) {
      const Aabb item = bounds_of(node.scene, groups.item_groups[0], layout.sets[0].order[i], 0);
      EXPECT_TRUE(glm::all(glm::lessThanEqual(box.min, glm::dvec3(item.min))));
      EXPECT_TRUE(glm::all(glm::greaterThanEqual(box.max, glm::dvec3(item.max))));
    }
  }
}

TEST(InstanceLayout, OnlyRigidOnesOfOneHandAreGroups) {
  Boxes flat(5), mirrored(5), far_off(5), mixed(5);
  flat.instances.scale[2] = {1, 0, 1};
  far_off.instances.translation[4].x = 1e20f;
  mixed.instances.scale[0].x *= -1;
  for (glm::vec3& s : mirrored.instances.scale) s.x *= -1;
  EXPECT_TRUE(layout_instances(flat.made()).sets.empty());
  EXPECT_TRUE(layout_instances(far_off.made()).sets.empty());
  EXPECT_TRUE(layout_instances(mixed.made()).sets.empty());
  ASSERT_EQ(layout_instances(mirrored.made()).sets.size(), 1u);
  EXPECT_TRUE(layout_instances(mirrored.made()).sets[0].mirrored);
  Boxes blended(5);
  const InstanceLayout layout = layout_instances(blended.made());
  Pose pose = evaluate_pose(blended.scene, {}, 0);
  EXPECT_EQ(make_frame_data(blended.scene, pose, {}, 0, {nullptr, &layout}).item_groups.size(), 1u);
  pose.materials[0].alpha_mode = AlphaMode::blend;
  EXPECT_TRUE(make_frame_data(blended.scene, pose, {}, 0, {nullptr, &layout}).item_groups.empty());
}

}  // namespace candela
