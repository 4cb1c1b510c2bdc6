#include "plan/frame_views.h"

#include "../unit/placed_views.h"
#include "passes/geometry/cull.h"
#include "passes/geometry/cull_compact.h"
#include "passes_cull_fixture.h"

// Culling for many views at once: cascades, cube faces and spots side by side, against double precision.
namespace candela::gpu::test {
namespace {

// Faces of cubes (square perspective views with a far plane) and orthographic views without a near plane, by turns.
std::vector<shared::View> random_views(size_t count, Rng& rng) {
  std::vector<shared::View> views;
  for (size_t v = 0; v < count; ++v) {
    const glm::dvec3 eye(random_vector(rng, 20));
    const glm::dmat4 turned =
        glm::mat4_cast(glm::normalize(glm::dquat(rng.uniform(-1, 1), glm::dvec3(random_vector(rng, 1)))));
    const double range_m = rng.uniform(5, 40);
    const bool is_face = v % 2 == 0;
    const glm::dmat4 clip = (is_face ? perspective_reversed_infinite(1, 1, 0.05)
                                     : orthographic_reversed(range_m / 2, range_m / 3, 0.0, range_m)) *
                            turned * relative_from_world(eye);
    shared::View view{};
    view.clip_from_relative = glm::mat4(clip);
    const FrustumPlanes planes = frustum_planes(clip);
    for (size_t p = 0; p < 4; ++p) view.planes[p] = glm::vec4(planes[p]);
    const glm::dvec3 back = glm::transpose(glm::dmat3(turned))[2];
    view.planes[4] = glm::vec4(glm::dvec4(back, range_m - glm::dot(back, eye)));
    view.size_px = {1024, 1024};
    views.push_back(view);
  }
  return views;
}

std::vector<DrawBatch> runs_of(const std::vector<uint32_t>& lengths) {
  std::vector<DrawBatch> runs;
  uint32_t first = 0;
  for (const uint32_t length : lengths) {
    DrawBatch run;
    run.first = first;
    run.count = length;
    runs.push_back(run);
    first += length;
  }
  return runs;
}

class ViewCulling : public PassTest {
 protected:
  struct Result {
    std::vector<shared::DrawCommand> commands;
    std::vector<uint32_t> counts;  // a view and run
  };
  Result cull(const FrameViews& views, const std::vector<shared::Item>& items, const std::vector<uint32_t>& lengths,
              uint32_t first = 0, uint32_t count = 0, bool enabled = true) {
    if (count == 0) count = uint32_t(views.table.size());
    imports.clear();
    const std::vector<shared::CullGroup> groups = cull_groups(lengths);
    const Buffer item_buffer = upload(items, "items"), group_buffer = upload(groups, "groups"),
                 view_buffer = upload(views.table, "views"), region_buffer = upload(views.first_command, "regions");
    shared::FrameConstants frame{};
    frame.items = item_buffer.address();
    const Buffer constants = upload(std::vector{frame}, "constants");

    GraphBuilder builder;
    SceneInputs scene;
    scene.constants = import(builder, constants, "constants");
    scene.items = import(builder, item_buffer, "items");
    scene.cull_groups = import(builder, group_buffer, "groups");
    scene.draw_batches = std::make_shared<const std::vector<DrawBatch>>(runs_of(lengths));
    scene.item_count = uint32_t(items.size());
    scene.cull_group_count = uint32_t(groups.size());
    ViewRange range;
    range.table = import(builder, view_buffer, "views");
    range.regions = import(builder, region_buffer, "regions");
    range.first = first;
    range.count = count;
    range.first_command = std::make_shared<const std::vector<uint32_t>>(views.first_command);
    Cull pass;
    pass.knobs.enabled = enabled ? 1 : 0;
    const Cull::Out culled = add(builder, pass, {scene, range});
    const Draws draws = add(builder, CullCompact{}, {scene, culled.masks, culled.survivors, range}).draws;
    const uint64_t room = std::max<uint64_t>(views.first_command.back(), 1);
    const BufferHandle commands = read_words(builder, "commands", draws.commands, room * sizeof(shared::DrawCommand));
    const BufferHandle counts = read_words(builder, "counts", draws.counts, count * lengths.size() * 4);
    const FrameRun result = run_all(builder);
    return {values_of<shared::DrawCommand>(*result.readbacks.at(commands.resource)),
            values_of<uint32_t>(*result.readbacks.at(counts.resource))};
  }

  static FrameViews placed(const std::vector<shared::View>& views, const std::vector<shared::Item>& items,
                           const std::vector<uint32_t>& lengths, bool culling = true) {
    auto result = candela::test::placed_views(views, items, runs_of(lengths), culling, 1 << 24);
    EXPECT_TRUE(result) << (result ? "" : result.error().text());
    return *result;
  }

  // Every view's commands are those of the items that reach into it, in item order, from its region's first place and
  // inside of its region. Items within rounding of a plane may stay.
  static void expect_double_precision(const FrameViews& views, const std::vector<shared::Item>& items,
                                      const std::vector<uint32_t>& lengths, const Result& result) {
    for (size_t v = 0; v < views.table.size(); ++v) {
      uint32_t first = 0;
      for (size_t r = 0; r < lengths.size(); ++r) {
        const size_t region = v * lengths.size() + r;
        const uint32_t begin = views.first_command[region], room = views.first_command[region + 1] - begin;
        ASSERT_LE(result.counts[region], room) << "view " << v << " run " << r;
        uint32_t place = 0;
        for (uint32_t i = first; i < first + lengths[r]; ++i) {
          const Margin m = margin(items[i], views.table[v].planes);
          const bool kept = place < result.counts[region] && result.commands[begin + place].first_instance == i;
          if (!is_finite(items[i]) || m.reach >= 0) {
            ASSERT_TRUE(kept) << "view " << v << " item " << i << " reaches " << m.reach << " m inside";
          } else if (m.reach < -8 * 0x1p-23 * m.scale) {
            ASSERT_FALSE(kept) << "view " << v << " item " << i << " is " << -m.reach << " m outside";
          }
          if (!kept) continue;
          const shared::DrawCommand& c = result.commands[begin + place++];
          ASSERT_EQ(c.index_count, items[i].index_count);
          ASSERT_EQ(c.first_index, items[i].first_index);
          ASSERT_EQ(c.instance_count, 1u);
        }
        ASSERT_EQ(result.counts[region], place) << "view " << v << " run " << r;
        first += lengths[r];
      }
    }
  }
};

}  // namespace

TEST_F(ViewCulling, EqualsBruteForceInDoubleForViewsAndRuns) {
  Rng rng(21);
  const std::vector<uint32_t> lengths = {1, 256, 300, 3, 700};
  std::vector<shared::Item> items = random_items(1260, rng);
  for (uint32_t i = 0; i < items.size(); i += 50) items[i].bounds_extent[int(i / 50 % 3)] = i % 100 ? nan : infinite;
  const FrameViews views = placed(random_views(37, rng), items, lengths);
  const Result result = cull(views, items, lengths);
  expect_double_precision(views, items, lengths, result);
  uint64_t drawn = 0;
  for (const uint32_t count : result.counts) drawn += count;
  EXPECT_LT(drawn, items.size() * 37 / 3);
  EXPECT_GT(drawn, items.size());
}

TEST_F(ViewCulling, ARangeOfTheTableGivesWhatTheWholeTableGivesThere) {
  Rng rng(22);
  const std::vector<uint32_t> lengths = {40, 500};
  const std::vector<shared::Item> items = random_items(540, rng);
  const std::vector<shared::View> views = random_views(9, rng);
  const Result all = cull(placed(views, items, lengths), items, lengths);
  FrameViews middle = placed({views.begin() + 3, views.begin() + 7}, items, lengths);
  middle.table = views;
  const Result some = cull(middle, items, lengths, 3, 4);
  for (size_t region = 0; region < 8; ++region) EXPECT_EQ(some.counts[region], all.counts[6 + region]);
}

TEST_F(ViewCulling, SwitchedOffKeepsEverythingInOrderInEveryView) {
  Rng rng(23);
  const std::vector<uint32_t> lengths = {257, 20};
  const std::vector<shared::Item> items = random_items(277, rng);
  const FrameViews views = placed(random_views(3, rng), items, lengths, false);
  const Result result = cull(views, items, lengths, 0, 0, false);
  EXPECT_EQ(result.counts, (std::vector<uint32_t>{257, 20, 257, 20, 257, 20}));
  for (uint32_t c = 0; c < 3 * 277; ++c) EXPECT_EQ(result.commands[c].first_instance, c % 277);
}

TEST_F(ViewCulling, WhatAFinerViewServesAndWhatIsTooSmallIsLeftOut) {
  shared::View view{};
  const glm::dmat4 clip = orthographic_reversed(32, 32, 0, 100);
  view.clip_from_relative = glm::mat4(clip);
  const FrustumPlanes planes = frustum_planes(clip);
  for (size_t p = 0; p < 4; ++p) view.planes[p] = glm::vec4(planes[p]);
  view.size_px = {64, 64};  // a texel is a metre
  view.flags = shared::view_has_served;
  for (int p = 0; p < 4; ++p) view.served[p] = {0, 0, 0, 8};
  view.served[0].x = view.served[2].y = 1;
  view.served[1].x = view.served[3].y = -1;  // the square from -8 to 8
  view.least_px = 1;
  const std::vector<shared::Item> items = {
      item({0, 0, -10}, glm::vec3(2), 0),       // inside of the finer view
      item({7, 0, -10}, glm::vec3(2), 1),       // reaches out of it
      item({0, 0, -10}, glm::vec3(8), 2),       // as wide as it: kept within rounding
      item({20, 0, -10}, glm::vec3(0.49f), 3),  // smaller than a texel
      item({20, 0, -10}, glm::vec3(0.1f, 0.51f, 0.1f), 4),
      item({20, 0, -10}, glm::vec3(0.1f, nan, 0.1f), 5),
      item({20, 0, 500}, glm::vec3(1), 6),  // in front of the near plane: it casts
  };
  const std::vector<uint32_t> lengths = {7};
  const Result result = cull(placed({view}, items, lengths), items, lengths);
  ASSERT_EQ(result.counts[0], 5u);
  for (uint32_t c = 0; c < 5; ++c) EXPECT_EQ(result.commands[c].first_instance, (std::vector{1u, 2u, 4u, 5u, 6u})[c]);
}

}  // namespace candela::gpu::test
