#include "passes/geometry/cull.h"
#include "passes/geometry/cull_compact.h"
#include "passes_cull_fixture.h"

namespace candela::gpu::test {

class Culling : public PassTest {
 protected:
  struct Result {
    std::vector<shared::DrawCommand> commands;
    std::vector<uint32_t> counts;  // a run
  };

  // Culls the items, cut into runs of the given lengths.
  Result cull(shared::FrameConstants frame, const std::vector<shared::Item>& items, const std::vector<uint32_t>& runs,
              bool enabled = true) {
    imports.clear();
    const std::vector<shared::CullGroup> groups = cull_groups(runs);
    const Buffer item_buffer = upload(items, "items"), group_buffer = upload(groups, "groups");
    frame.items = item_buffer.address();
    frame.item_count = uint32_t(items.size());
    const Buffer constants = upload(std::vector{frame}, "constants");

    GraphBuilder builder;
    SceneInputs scene;
    scene.constants = import(builder, constants, "constants");
    scene.items = import(builder, item_buffer, "items");
    scene.cull_groups = import(builder, group_buffer, "groups");
    scene.draw_batches = std::make_shared<const std::vector<DrawBatch>>(runs.size());
    scene.item_count = uint32_t(items.size());
    scene.cull_group_count = uint32_t(groups.size());
    Cull pass;
    pass.knobs.enabled = enabled ? 1 : 0;
    const Cull::Out culled = add(builder, pass, {scene});
    const Draws draws = add(builder, CullCompact{}, {scene, culled.masks, culled.survivors}).draws;
    const BufferHandle commands =
        read_words(builder, "commands", draws.commands, items.size() * sizeof(shared::DrawCommand));
    const BufferHandle counts = read_words(builder, "counts", draws.counts, runs.size() * 4);
    const FrameRun result = run_all(builder);
    return {values_of<shared::DrawCommand>(*result.readbacks.at(commands.resource)),
            values_of<uint32_t>(*result.readbacks.at(counts.resource))};
  }

  // The commands must be those of the surviving items in item order, without gaps from each run's first place. Items
  // within rounding of a plane may also stay, up to twice the shader's allowance of 4 epsilons.
  void expect_brute_force(const shared::FrameConstants& frame, const std::vector<shared::Item>& items,
                          const std::vector<uint32_t>& runs) {
    const Result result = cull(frame, items, runs);
    uint32_t first = 0, culled = 0;
    for (size_t r = 0; r < runs.size(); ++r) {
      uint32_t place = 0;
      for (uint32_t i = first; i < first + runs[r]; ++i) {
        const Margin m = margin(items[i], frame.planes);
        const bool kept = place < result.counts[r] && result.commands[first + place].first_instance == i;
        if (!is_finite(items[i]) || m.reach >= 0) {
          EXPECT_TRUE(kept) << "run " << r << " item " << i << " reaches " << m.reach << " m inside";
        } else if (m.reach < -8 * 0x1p-23 * m.scale) {
          EXPECT_FALSE(kept) << "run " << r << " item " << i << " is " << -m.reach << " m outside";
        }
        culled += kept ? 0 : 1;
        if (!kept) continue;
        const shared::DrawCommand& c = result.commands[first + place++];
        EXPECT_EQ(c.index_count, items[i].index_count);
        EXPECT_EQ(c.first_index, items[i].first_index);
        EXPECT_EQ(c.instance_count, 1u);
        EXPECT_EQ(c.vertex_offset, 0);
      }
      EXPECT_EQ(result.counts[r], place) << "run " << r;
      first += runs[r];
    }
    culled_fraction = double(culled) / double(items.size());
  }

  static shared::FrameConstants frame_of(const glm::dmat4& clip_from_relative) {
    shared::FrameConstants frame{};
    const FrustumPlanes planes = frustum_planes(clip_from_relative);
    for (size_t p = 0; p < 5; ++p) frame.planes[p] = glm::vec4(planes[p]);
    return frame;
  }

  double culled_fraction = 0;
};

TEST_F(Culling, EqualsBruteForceInDoubleForEveryGroupFilling) {
  Rng rng(1);
  const shared::FrameConstants perspective = frame_of(perspective_reversed_infinite(0.9, 0.6, 0.05) * rotation());
  const shared::FrameConstants orthographic = frame_of(orthographic_reversed(12, 9, 0.5, 40) * rotation());
  for (const uint32_t count : {1u, 255u, 256u, 257u, 1000u})
    for (const auto& frame : {perspective, orthographic}) {
      expect_brute_force(frame, random_items(count, rng), {count});
      if (count == 1000) {
        EXPECT_GT(culled_fraction, 0.3);
        EXPECT_LT(culled_fraction, 0.95);
      }
    }
}

TEST_F(Culling, RunsDoNotMix) {
  Rng rng(2);
  const std::vector<uint32_t> runs = {1, 256, 3, 257, 512, 255, 1000, 2};
  for (const bool is_perspective : {true, false})
    expect_brute_force(frame_of((is_perspective ? perspective_reversed_infinite(1.2, 0.7, 0.1)
                                                : orthographic_reversed(20, 10, 0, 60)) *
                                rotation()),
                       random_items(2286, rng), runs);
}

TEST_F(Culling, RunsThatAreCulledWholeHaveCountZero) {
  const shared::FrameConstants frame = frame_of(perspective_reversed_infinite(1, 1, 0.1));
  std::vector<shared::Item> items;
  for (uint32_t i = 0; i < 700; ++i) items.push_back(item({0, 0, i < 300 ? 5.0f : -5.0f}, glm::vec3(1), i));
  expect_brute_force(frame, items, {300, 400});
  EXPECT_EQ(cull(frame, items, {300, 400}).counts, (std::vector<uint32_t>{0, 400}));
}

TEST_F(Culling, BoundsThatAreNotFiniteStay) {
  Rng rng(3);
  std::vector<shared::Item> items = random_items(300, rng);
  for (uint32_t i = 0; i < 300; i += 5) {
    shared::Item& t = items[i];
    t.bounds_centre = {0, 0, 50};  // behind: a finite box here would go
    t.bounds_extent = glm::vec3(1);
    if (i % 4 == 0) t.bounds_centre[int(i / 20) % 3] = nan;
    if (i % 4 == 1) t.bounds_extent[int(i / 20) % 3] = nan;
    if (i % 4 == 2)
      t.bounds_centre = glm::vec3(0), t.bounds_extent = glm::vec3(infinite);  // as frame_upload writes them
    if (i % 4 == 3) t.bounds_centre = glm::vec3(nan), t.bounds_extent = glm::vec3(infinite);
  }
  expect_brute_force(frame_of(perspective_reversed_infinite(0.9, 0.6, 0.05)), items, {300});
}

// Boxes whose corner touches a plane up to the rounding of their own numbers: none may go.
TEST_F(Culling, BoxesThatTouchAPlaneWithinRoundingStay) {
  Rng rng(4);
  for (int trial = 0; trial < 4; ++trial) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(random_vector(rng, 1)));
    const double w = trial % 2 ? rng.uniform(-3, 3) : 0;
    shared::FrameConstants frame{};
    for (glm::vec4& plane : frame.planes) plane = glm::vec4(glm::dvec4(n, w));
    std::vector<shared::Item> items;
    for (uint32_t i = 0; i < 1000; ++i) {
      const double size = std::exp2(rng.uniform(-10, 20));
      const glm::vec3 e = glm::abs(random_vector(rng, size));
      const glm::dvec3 along = glm::dvec3(random_vector(rng, size));
      const glm::dvec4 plane(frame.planes[0]);
      const glm::dvec3 pn(plane);
      const double gap = glm::dot(pn, along) + plane.w + glm::dot(glm::abs(pn), glm::dvec3(e));
      items.push_back(item(glm::vec3(along - pn * (gap / glm::dot(pn, pn))), e, i));
    }
    const Result result = cull(frame, items, {1000});
    EXPECT_EQ(result.counts[0], 1000u);
    uint32_t outside = 0;
    for (const shared::Item& i : items) outside += margin(i, frame.planes).reach < 0;
    EXPECT_GT(outside, 200u);  // rounding does put many of them outside
  }
}

TEST_F(Culling, SwitchedOffKeepsEverythingInOrder) {
  Rng rng(5);
  const std::vector<shared::Item> items = random_items(513, rng);
  const Result result = cull(frame_of(perspective_reversed_infinite(0.2, 0.2, 0.1)), items, {513}, false);
  EXPECT_EQ(result.counts[0], 513u);
  for (uint32_t i = 0; i < 513; ++i) EXPECT_EQ(result.commands[i].first_instance, i);
}

TEST_F(Culling, IsLeftOutWithoutItems) {
  EXPECT_FALSE(Cull{}.needed({}, {}).yes);
  EXPECT_FALSE(Cull{}.needed({}, {}).reason.empty());
  EXPECT_FALSE(CullCompact{}.needed({}, {}).yes);
}

}  // namespace candela::gpu::test
