#include <gtest/gtest.h>

#include "graph_random.h"

namespace candela {
namespace {

PlanResource image(uint32_t width, int first, int last) {
  PlanResource r{.desc = ImageDesc{.name = "i", .format = VK_FORMAT_R8_UNORM, .width_px = width, .height_px = 1}};
  r.first_pass = first, r.last_pass = last, r.bytes = width;
  return r;
}

TEST(GraphAlias, LargestFirstIntoTheFirstFreeBlock) {
  FramePlan plan;
  plan.resources = {image(10, 0, 1), image(100, 2, 3), image(50, 1, 2), image(20, 4, 4), image(7, -1, -1)};
  alias_memory(plan);
  EXPECT_EQ(plan.resources[1].block, 0);
  EXPECT_EQ(plan.resources[2].block, 1) << "alive in pass 2 like the largest";
  EXPECT_EQ(plan.resources[3].block, 0);
  EXPECT_EQ(plan.resources[0].block, 0);
  EXPECT_EQ(plan.resources[4].block, -1) << "unused";
  EXPECT_EQ(plan.block_bytes, (std::vector<uint64_t>{100, 50}));
  EXPECT_EQ(transient_bytes(plan), 150u);
  EXPECT_EQ(transient_bytes_unaliased(plan), 180u);
}

TEST(GraphAlias, BuffersShareAmongThemselves) {
  FramePlan plan;
  const auto buffer = [](uint64_t bytes, int first, int last, bool zeroed = false) {
    PlanResource r{.desc = BufferDesc{.name = "b", .size_bytes = bytes << 16, .zeroed = zeroed}};
    r.first_pass = first, r.last_pass = last, r.bytes = bytes << 16;
    return r;
  };
  PlanResource read = buffer(30, 4, 4);
  read.lifetime = Lifetime::readback;
  plan.resources = {buffer(10, 0, 1),
                    buffer(100, 2, 3),
                    buffer(50, 1, 2),
                    buffer(20, 4, 4),
                    buffer(60, 4, 4, true),
                    image(100, 0, 0),
                    read};
  alias_memory(plan);
  EXPECT_EQ(plan.resources[0].block, plan.resources[1].block);
  EXPECT_NE(plan.resources[2].block, plan.resources[1].block) << "alive in pass 2 like the largest";
  EXPECT_EQ(plan.resources[3].block, plan.resources[1].block);
  EXPECT_EQ(plan.resources[4].block, -1) << "filled before the first pass";
  EXPECT_NE(plan.resources[5].block, plan.resources[1].block) << "an image";
  EXPECT_EQ(plan.resources[6].block, -1) << "read by the host";
  EXPECT_EQ(transient_bytes(plan), ((100 + 50 + 60) << 16) + 100u);
  EXPECT_EQ(transient_bytes_unaliased(plan), ((10 + 100 + 50 + 20 + 60) << 16) + 100u);
  plan.resources[0].bytes = 65535;
  alias_memory(plan);
  EXPECT_EQ(plan.resources[0].block, -1) << "not worth a wait";
}

TEST(GraphAlias, LivingResourcesNeverShare) {
  for (uint32_t seed = 0; seed < 300; ++seed) {
    const FramePlan plan = compile_graph(test::RandomGraph(seed).builder()).plan;
    for (const PlanResource& a : plan.resources) {
      if (a.block >= 0) {
        ASSERT_GE(a.first_pass, 0);
        ASSERT_GE(plan.block_bytes[a.block], a.bytes);
      }
      for (const PlanResource& b : plan.resources)
        if (&a != &b && a.block >= 0 && a.block == b.block) {
          ASSERT_TRUE(a.last_pass < b.first_pass || b.last_pass < a.first_pass) << "seed " << seed;
        }
    }
    ASSERT_LE(transient_bytes(plan), transient_bytes_unaliased(plan));
  }
}

TEST(GraphAlias, ASinkKeepsItsMemoryToTheEnd) {
  GraphBuilder builder;
  builder.begin_pass("a");
  const ImageHandle kept = builder.write(
      builder.create(ImageDesc{.name = "kept", .format = VK_FORMAT_R8_UNORM, .width_px = 4, .height_px = 4}),
      Access::color_attachment);
  builder.end_pass({});
  builder.begin_pass("b");
  const ImageHandle other = builder.write(
      builder.create(ImageDesc{.name = "other", .format = VK_FORMAT_R8_UNORM, .width_px = 4, .height_px = 4}),
      Access::color_attachment);
  builder.end_pass({});
  builder.sink(kept);
  builder.sink(other);
  const FramePlan plan = compile_graph(builder).plan;
  EXPECT_NE(plan.resources[0].block, plan.resources[1].block);
}

}  // namespace
}  // namespace candela
