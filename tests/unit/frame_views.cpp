#include "plan/frame_views.h"

#include <gtest/gtest.h>

#include "base/rng.h"
#include "math/bounds.h"
#include "math/transforms.h"
#include "placed_views.h"

namespace candela {
namespace {

// The six faces of a cube around a light that reaches range_m.
void add_cube(glm::dvec3 position, double range_m, std::vector<shared::View>& views) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      glm::dvec3 back(0), up(0);
      back[axis] = sign;
      up[(axis + 1) % 3] = 1;
      const glm::dmat4 turned(glm::transpose(glm::dmat3(glm::cross(up, back), up, back)));
      const glm::dmat4 clip = perspective_reversed_infinite(1, 1, 0.05) * turned * relative_from_world(position);
      shared::View view{};
      view.clip_from_relative = glm::mat4(clip);
      const FrustumPlanes planes = frustum_planes(clip);
      for (size_t p = 0; p < 4; ++p) view.planes[p] = glm::vec4(planes[p]);
      view.planes[4] = glm::vec4(glm::dvec4(back, range_m - glm::dot(back, position)));
      views.push_back(view);
    }
}

glm::dvec3 random_point(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

std::vector<shared::Item> random_items(size_t count, double size, Rng& rng) {
  std::vector<shared::Item> items(count);
  for (shared::Item& item : items) {
    item.bounds_centre = glm::vec3(random_point(rng, size));
    item.bounds_extent = glm::abs(glm::vec3(random_point(rng, 1)));
  }
  return items;
}

DrawBatch run(uint32_t first, uint32_t count, AlphaMode alpha = AlphaMode::opaque,
              Topology topology = Topology::triangles) {
  DrawBatch r;
  r.first = first;
  r.count = count;
  r.alpha = alpha;
  r.topology = topology;
  return r;
}

}  // namespace

TEST(FrameViews, RegionsFollowOneAnotherAndHoldWhatIsDrawn) {
  Rng rng(31);
  const auto items = random_items(400, 30, rng);
  const std::vector<DrawBatch> runs = {run(0, 100), run(100, 50, AlphaMode::mask),
                                       run(150, 50, AlphaMode::opaque, Topology::lines),
                                       run(200, 200, AlphaMode::blend)};
  std::vector<shared::View> views;
  add_cube({3, 1, -4}, 12, views);
  const auto placed = test::placed_views(views, items, runs, true, 1 << 20);
  ASSERT_TRUE(placed);
  ASSERT_EQ(placed->first_command.size(), 6 * 4 + 1u);
  for (size_t v = 0; v < 6; ++v) {
    for (size_t r = 0; r < 4; ++r) {
      const size_t region = 4 * v + r;
      uint32_t reaching = 0;
      for (uint32_t i = runs[r].first; i < runs[r].first + runs[r].count; ++i) {
        bool outside = false;
        for (const glm::vec4& p : views[v].planes) {
          const glm::dvec3 n(p);
          outside |= glm::dot(n, glm::dvec3(items[i].bounds_centre)) + double(p.w) +
                         glm::dot(glm::abs(n), glm::dvec3(items[i].bounds_extent)) <
                     -1e-4;
        }
        reaching += !outside;
      }
      EXPECT_EQ(placed->first_command[region + 1] - placed->first_command[region], r < 2 ? reaching : 0u)
          << "view " << v << " run " << r << ": neither lines nor blended surfaces cast a shadow";
    }
  }
  EXPECT_GT(placed->first_command.back(), 0u);
}

// Of clusters all items have room where any may be kept; the host's items of the other runs keep theirs.
TEST(FrameViews, ClustersHaveRoomForAllThatMayBeKept) {
  Rng rng(7);
  auto items = random_items(300, 10, rng);
  for (size_t i = 100; i < 200; ++i) items[i] = items[i / 4 * 4];  // a cluster is at one place
  const std::vector<DrawBatch> runs = {run(0, 100), run(100, 100, AlphaMode::mask), run(200, 100)};
  std::vector<shared::View> views;
  add_cube({3, 1, -4}, 12, views);
  const auto expected = test::placed_views(views, items, runs, true, 1 << 20);
  std::vector<shared::Item> host(items.begin(), items.begin() + 100);
  host.insert(host.end(), items.begin() + 200, items.end());
  std::vector<ItemCluster> clusters;
  for (uint32_t first = 100; first < 200; first += 4) {
    DAabb box;
    for (uint32_t i = first; i < first + 4; ++i)
      box.add(DAabb{glm::dvec3(items[i].bounds_centre) - glm::dvec3(items[i].bounds_extent),
                    glm::dvec3(items[i].bounds_centre) + glm::dvec3(items[i].bounds_extent)});
    clusters.push_back({1, 4, 0, box.centre(), box.extent()});
  }
  const auto placed = test::placed_views(views, host, runs, true, 1 << 20, "sun.draws", false, clusters);
  const auto unculled = test::placed_views(views, host, runs, false, 1 << 20, "sun.draws", false, clusters);
  ASSERT_TRUE(expected && placed && unculled);
  EXPECT_EQ(unculled->first_command.back(), 6 * 300u);
  for (size_t region = 0; region < 6 * 3; ++region) {
    const auto room = [&](const FrameViews& v) { return v.first_command[region + 1] - v.first_command[region]; };
    if (region % 3 == 1)
      EXPECT_GE(room(*placed), room(*expected)) << region;
    else
      EXPECT_EQ(room(*placed), room(*expected)) << region;
  }
}

// Where the views are without what stands, and without what moves, their draws are as many as without either.
TEST(FrameViews, CountWhatMoves) {
  Rng rng(8);
  auto items = random_items(300, 10, rng);
  for (uint32_t i = 0; i < items.size(); ++i) items[i].object_id = i % 40;
  const std::vector<DrawBatch> runs = {run(0, 100), run(100, 108, AlphaMode::mask), run(208, 100)};
  const ItemCluster standing{1, 4, 34, {3, 1, -4}, {1, 1, 1}}, moves{1, 4, 35, {3, 1, -4}, {1, 1, 1}};
  const std::vector<uint32_t> bits = {1u << 7, 1u << 3};  // nodes 7 and 35
  std::vector<shared::View> views;
  add_cube({3, 1, -4}, 12, views);
  for (const bool culling : {true, false}) {
    ViewCasters casters(nullptr, bits);
    const auto placed = test::placed_views(views, items, runs, culling, 1 << 20, "local.draws", false,
                                           std::vector{standing, moves}, &casters);
    ASSERT_TRUE(placed);
    // The same where all else draws nothing.
    auto moving = items;
    for (shared::Item& item : moving)
      if (item.object_id != 7 && item.object_id != 35) item.bounds_centre = glm::vec3(1e4f), item.bounds_extent = {};
    const auto alone = test::placed_views(views, moving, runs, true, 1 << 20, "local.draws", false,
                                          std::vector{moves, ItemCluster{1, 4, 34, glm::dvec3(1e4), {}}});
    ASSERT_EQ(casters.of_view.size(), 6u);
    for (size_t region = 0; culling && region < 6 * 3; ++region)
      EXPECT_EQ(casters.of_view[region / 3].moving_counts[region % 3],
                alone->first_command[region + 1] - alone->first_command[region])
          << region;
    if (culling) continue;
    for (const ViewCasters::OfView& v : casters.of_view) {
      uint32_t count = 0;
      for (const uint32_t of_run : v.moving_counts) count += of_run;
      EXPECT_EQ(count, 8 + 7 + 4u);
    }
  }
}

TEST(FrameViews, TooManyDrawsAreAnErrorThatNamesTheNeedAndTheKnob) {
  Rng rng(32);
  const auto items = random_items(300, 5, rng);
  const std::vector<DrawBatch> runs = {run(0, 300)};
  std::vector<shared::View> views;
  add_cube({0, 0, 0}, 100, views);
  const auto all = test::placed_views(views, items, runs, false, 1800);
  ASSERT_TRUE(all) << "exactly the budget fits";
  EXPECT_EQ(all->first_command.back(), 1800u);
  const auto none = test::placed_views(views, items, runs, false, 1799);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::usage);
  EXPECT_NE(none.error().message.find("1800"), std::string::npos) << none.error().message;
  EXPECT_NE(none.error().message.find("sun.draws"), std::string::npos) << none.error().message;
  const auto lamps = test::placed_views(views, items, runs, false, 1799, "local.draws");
  ASSERT_FALSE(lamps);
  EXPECT_NE(lamps.error().message.find("local.draws"), std::string::npos) << lamps.error().message;
}

TEST(FrameViews, ManyCubeFacesTakeWhatIsDrawnAndNotAFullBufferEach) {
  Rng rng(33);
  const auto items = random_items(20000, 150, rng);
  const std::vector<DrawBatch> runs = {run(0, 20000)};
  std::vector<shared::View> views;
  for (int light = 0; light < 256; ++light) add_cube(random_point(rng, 150), 15, views);
  ASSERT_EQ(views.size(), 1536u);
  const auto placed = test::placed_views(views, items, runs, true, uint64_t(1) << 22);
  ASSERT_TRUE(placed) << placed.error().text();
  const uint64_t groups = (20000 + shared::cull_group_size - 1) / shared::cull_group_size;
  const uint64_t bytes = uint64_t(placed->first_command.back()) * sizeof(shared::DrawCommand) +
                         views.size() * (groups * (shared::cull_mask_words + 1) * 4 + sizeof(shared::View) + 2 * 4);
  const uint64_t full = views.size() * items.size() * sizeof(shared::DrawCommand);
  EXPECT_EQ(full, 614'400'000u);
  EXPECT_LT(bytes, full / 50);
  RecordProperty("bytes", std::to_string(bytes));
  RecordProperty("draws", std::to_string(placed->first_command.back()));
}

}  // namespace candela
