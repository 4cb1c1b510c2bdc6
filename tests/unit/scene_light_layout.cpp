#include "scene/light_layout.h"

#include <gtest/gtest.h>

#include "base/rng.h"
#include "scene/frame_data.h"

namespace candela {
namespace {

struct OneNode {
  Scene scene;
  LightInstances instances;
  explicit OneNode(uint32_t count) {
    Rng rng(3);
    instances.light = 0;
    for (uint32_t i = 0; i < count; ++i) {
      instances.translation.emplace_back(rng.uniform(-50, 50), rng.uniform(0, 5), rng.uniform(-50, 50));
      instances.intensity.push_back(float(rng.uniform(1, 2)));
      instances.range_m.push_back(float(rng.uniform(1, 4)));
      instances.modulation.push_back({0.5f, 1, float(rng.uniform())});
    }
    scene.lights.push_back({"lamp", LightType::point, glm::vec3(1, 0.5f, 0.25f), 4, 9});
    scene.nodes.emplace_back();
    scene.order = {0};
  }
  Scene& made() {
    scene.nodes[0].light_instances = std::make_shared<const LightInstances>(instances);
    return scene;
  }
  FrameData frame() {
    layout = layout_lights(made());
    return make_frame_data(scene, evaluate_pose(scene, {}, 0), {}, 0, {&layout});
  }
  LightLayout layout;  // as long as groups of it
};

}  // namespace

TEST(LightLayout, ClustersHoldTheInstances) {
  OneNode node(1000);
  const LightLayout layout = layout_lights(node.made());
  ASSERT_EQ(layout.sets.size(), 1u);
  const LightSet& set = layout.sets[0];
  EXPECT_EQ(set.count, 1000u);
  std::vector<uint32_t> within(set.clusters.size(), 0);
  uint32_t count = 0;
  float sum_m = 0;
  for (size_t c = 0; c < set.clusters.size(); ++c) {
    const LightCluster& cluster = set.clusters[c];
    count += cluster.count;
    sum_m += cluster.radius_m;
    for (size_t i = 0; i < node.instances.count(); ++i)
      within[c] += glm::distance(node.instances.translation[i], cluster.centre) <= cluster.radius_m &&
                   node.instances.range_m[i] <= cluster.range_m;
    EXPECT_GE(within[c], cluster.count);
  }
  EXPECT_EQ(count, 1000u);
  EXPECT_LT(sum_m / float(set.clusters.size()), 35) << "neighbours, not any instances";
  for (const glm::vec3& p : node.instances.translation) EXPECT_LE(glm::length(p), set.farthest_m);
}

// What may be dark, has no end or lies beyond what floats can square is posed light by light, which leaves it out.
TEST(LightLayout, OnlyLightsThatShineAtAnyTimeAreGroups) {
  OneNode node(20);
  EXPECT_EQ(node.frame().lights.size(), 0u);
  EXPECT_EQ(node.frame().light_groups.size(), 1u);
  EXPECT_EQ(node.frame().light_count(), 20u);
  OneNode dark = node;
  dark.instances.intensity[7] = 0;
  EXPECT_EQ(dark.frame().lights.size(), 19u);
  OneNode blinking = node;
  blinking.instances.modulation[7].depth = 1;
  EXPECT_EQ(blinking.frame().light_groups.size(), 0u);
  OneNode off = node;
  off.scene.lights[0].intensity = 0;
  EXPECT_EQ(off.frame().light_count(), 0u);
  OneNode red = node;
  red.scene.lights[0].color = {1, 0, 0};
  red.instances.color.assign(20, {0, 1, 0});
  EXPECT_EQ(red.frame().light_count(), 0u);
  OneNode endless = node;
  endless.instances.range_m.clear();
  endless.scene.lights[0].range_m = std::numeric_limits<float>::infinity();
  EXPECT_EQ(endless.frame().lights.size(), 20u);
  OneNode far_off = node;
  far_off.scene.nodes[0].translation.x = 1e16;
  EXPECT_EQ(far_off.frame().lights.size(), 20u);
}

}  // namespace candela
