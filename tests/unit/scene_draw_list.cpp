#include "scene/draw_list.h"

#include <gtest/gtest.h>

#include "scene_pieces.h"

// The order in which items are drawn, and the runs of equal state.
namespace candela::test {
namespace {

struct Listed {
  FrameData data;
  DrawList draws;
};
Listed listed(const GltfBuilder& builder) {
  SeenScene seen = seen_from_the_front(builder);
  DrawList draws = make_draw_list(seen.scene, seen.pose, seen.data);
  return {std::move(seen.data), std::move(draws)};
}

}  // namespace

TEST(DrawList, BlendedItemsComeLastAndFarthestFirst) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json glass = unlit_material(1, 1, 1, 0.5);
  glass["alphaMode"] = "BLEND";
  const int pane = add_square_mesh(b, 1, add_material(b, glass)),
            wall = add_square_mesh(b, 1, add_material(b, unlit_material(1, 1, 1)));
  add_node(b, {{"mesh", pane}, {"translation", {0, 0, 1}}});
  add_node(b, {{"mesh", pane}, {"translation", {0, 0, -3}}});
  add_node(b, {{"mesh", wall}});
  add_node(b, {{"mesh", pane}, {"translation", {0, 0, -1}}});
  const Listed l = listed(b);
  std::vector<uint32_t> nodes;
  for (const uint32_t i : l.draws.order) nodes.push_back(l.data.items[i].node);
  EXPECT_EQ(nodes, (std::vector<uint32_t>{2, 1, 3, 0}));
  ASSERT_EQ(l.draws.batches.size(), 2u);
  EXPECT_EQ(l.draws.batches[1].count, 3u);
}

// Bounds beyond what floats hold may have no depth: the others keep their order, and nothing is lost.
TEST(DrawList, BlendedItemsWithoutADepthAreStillInAnOrder) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json glass = unlit_material(1, 1, 1, 0.5);
  glass["alphaMode"] = "BLEND";
  const int pane = add_square_mesh(b, 1, add_material(b, glass));
  for (int i = 0; i < 60; ++i) add_node(b, {{"mesh", pane}, {"translation", {0, 0, -1 - (i * 7) % 60}}});
  SeenScene seen = seen_from_the_front(b);
  ASSERT_EQ(seen.data.items.size(), 60u);
  for (size_t i = 0; i < 60; i += 3) seen.data.items[i].view_depth_m = std::numeric_limits<double>::quiet_NaN();
  const DrawList draws = make_draw_list(seen.scene, seen.pose, seen.data);
  ASSERT_EQ(draws.order.size(), 60u);
  for (size_t i = 0; i < 20; ++i) EXPECT_EQ(draws.order[i], 3 * i);
  for (size_t i = 21; i < 60; ++i)
    EXPECT_GT(seen.data.items[draws.order[i - 1]].view_depth_m, seen.data.items[draws.order[i]].view_depth_m) << i;
}

TEST(DrawList, RunsPartByState) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json both = diffuse_material(1, 1, 1);
  both["doubleSided"] = true;
  const int one_sided = add_square_mesh(b, 1, add_material(b, diffuse_material(1, 1, 1))),
            two_sided = add_square_mesh(b, 1, add_material(b, both)),
            unlit = add_square_mesh(b, 1, add_material(b, unlit_material(1, 1, 1)));
  add_node(b, {{"mesh", two_sided}});
  add_node(b, {{"mesh", unlit}});
  add_node(b, {{"mesh", one_sided}, {"scale", {-1, 1, 1}}});
  add_node(b, {{"mesh", one_sided}});
  add_node(b, {{"mesh", one_sided}, {"scale", {-1, -1, 1}}});
  const Listed l = listed(b);
  uint32_t mirrored = 0, culled = 0, unlit_items = 0, next = 0;
  for (const DrawBatch& run : l.draws.batches) {
    EXPECT_EQ(run.first, next);
    next += run.count;
    mirrored += run.mirrored ? run.count : 0;
    culled += run.cull_back ? run.count : 0;
    unlit_items += run.unlit ? run.count : 0;
    EXPECT_EQ(run.topology, Topology::triangles);
  }
  EXPECT_EQ(next, 5u);
  EXPECT_EQ(l.draws.batches.size(), 4u);
  EXPECT_EQ(mirrored, 1u);
  EXPECT_EQ(culled, 4u);
  EXPECT_EQ(unlit_items, 1u);
}

}  // namespace candela::test
