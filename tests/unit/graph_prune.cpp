#include <gtest/gtest.h>

#include "graph/builder.h"

namespace candela {
namespace {

// Passes that read some buffers and write one new buffer each, named as the pass.
struct Buffers {
  GraphBuilder builder;
  BufferHandle pass(const std::string& name, std::vector<std::pair<BufferHandle, std::string>> required,
                    std::vector<BufferHandle> optional = {}) {
    builder.begin_pass(name);
    for (const auto& [handle, what] : required) builder.read(handle, Access::compute_read, what);
    for (const BufferHandle handle : optional) builder.read_optional(handle, Access::compute_read);
    const BufferHandle out = builder.write(builder.create(BufferDesc{name + "_out", 64}), Access::compute_write);
    return builder.end_pass({}) ? out : BufferHandle{.absence = builder.last_absence()};
  }
  static std::string names(const FramePlan& plan) {
    std::string result;
    for (const PlanPass& pass : plan.passes) result += (result.empty() ? "" : " ") + pass.name;
    return result;
  }
  static std::string reason(const FramePlan& plan, const std::string& pass) {
    for (const LeftOut& l : plan.left_out)
      if (l.pass == pass) return l.reason;
    return "not left out";
  }
};

TEST(GraphPrune, AChainNobodyReadsGoesWhole) {
  Buffers g;
  const BufferHandle a = g.pass("a", {}), b = g.pass("b", {{a, "a"}});
  g.pass("c", {{b, "b"}});
  g.builder.sink(g.pass("out", {}));
  const FramePlan plan = compile_graph(g.builder).plan;
  EXPECT_EQ(Buffers::names(plan), "out");
  ASSERT_EQ(plan.left_out.size(), 3u);
  EXPECT_EQ(plan.left_out[0].pass, "a");
  EXPECT_EQ(plan.left_out[0].reason, "nothing reads a_out");
  EXPECT_EQ(plan.left_out[2].reason, "nothing reads c_out");
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(plan.resources[i].first_pass, -1);
    EXPECT_EQ(plan.resources[i].buffer_usage, 0u);
    EXPECT_EQ(plan.resources[i].bytes, 0u);
  }
}

TEST(GraphPrune, ADiamondStaysAndItsSideBranchGoes) {
  Buffers g;
  const BufferHandle top = g.pass("top", {});
  const BufferHandle left = g.pass("left", {{top, "top"}}), side = g.pass("side", {{top, "top"}}),
                     right = g.pass("right", {{top, "top"}});
  g.builder.sink(g.pass("bottom", {{left, "left"}, {right, "right"}}));
  g.pass("after side", {{side, "side"}});
  const FramePlan plan = compile_graph(g.builder).plan;
  EXPECT_EQ(Buffers::names(plan), "top left right bottom");
  EXPECT_EQ(Buffers::reason(plan, "side"), "nothing reads side_out");
}

TEST(GraphPrune, NoSinkNoPass) {
  Buffers g;
  g.pass("a", {});
  EXPECT_TRUE(compile_graph(g.builder).plan.passes.empty());
}

TEST(GraphPrune, ALaterWriteThatNobodyReadsGoesAndTheEarlierStays) {
  Buffers g;
  const BufferHandle a = g.pass("a", {});
  g.builder.sink(g.pass("reader", {{a, "a"}}));
  g.builder.begin_pass("overwrite");
  g.builder.write(a, Access::compute_write);
  g.builder.end_pass({});
  EXPECT_EQ(Buffers::names(compile_graph(g.builder).plan), "a reader");
}

TEST(GraphPrune, AWriteKeepsWhatItWritesOnto) {
  Buffers g;
  const BufferHandle a = g.pass("a", {});
  g.builder.begin_pass("blend");
  const BufferHandle b = g.builder.write(a, Access::compute_write);
  g.builder.end_pass({});
  g.builder.sink(b);
  EXPECT_EQ(Buffers::names(compile_graph(g.builder).plan), "a blend");
}

// A pass that is kept for one image draws onto another: what was there before decides what it draws (a depth test).
TEST(GraphPrune, WhatAKeptPassDrawsOverIsMade) {
  for (const Access access : {Access::depth_attachment, Access::color_attachment}) {
    const bool is_depth = access == Access::depth_attachment;
    GraphBuilder builder;
    builder.begin_pass("before");
    ImageHandle over =
        builder.write(builder.create(ImageDesc{.name = "drawn over",
                                               .format = is_depth ? VK_FORMAT_D32_SFLOAT : VK_FORMAT_R8G8B8A8_UNORM,
                                               .width_px = 8,
                                               .height_px = 8}),
                      access);
    builder.end_pass({});
    builder.begin_pass("draw");
    builder.write(over, access);
    const ImageHandle color = builder.write(
        builder.create(ImageDesc{.name = "color", .format = VK_FORMAT_R8G8B8A8_UNORM, .width_px = 8, .height_px = 8}),
        Access::color_attachment);
    builder.end_pass({});
    builder.sink(color);
    EXPECT_EQ(Buffers::names(compile_graph(builder).plan), "before draw") << "depth " << is_depth;
  }
}

TEST(GraphPrune, PruningNarrowsUsage) {
  Buffers g;
  const BufferHandle a = g.pass("a", {});
  g.builder.begin_pass("draw");
  g.builder.read(a, Access::indirect_read, "a");
  g.builder.write(g.builder.create(BufferDesc{"unread", 4}), Access::fragment_write);
  g.builder.end_pass({});
  g.builder.sink(a);
  const FramePlan plan = compile_graph(g.builder).plan;
  EXPECT_FALSE(plan.resources[0].buffer_usage & VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT);
}

TEST(GraphPrune, AbsenceFlowsForwardWithItsReason) {
  Buffers g;
  const BufferHandle map{.absence = g.builder.leave_out("shadow_map", "no light casts a shadow")};
  const BufferHandle blur = g.pass("shadow_blur", {{map, "the shadow map"}});
  const BufferHandle fog = g.pass("fog", {{blur, "shadow_blur_out"}});
  g.builder.sink(g.pass("shade", {}, {fog, blur}));
  const FramePlan plan = compile_graph(g.builder).plan;
  EXPECT_EQ(Buffers::names(plan), "shade") << "its optional inputs are absent, it stays";
  EXPECT_TRUE(plan.passes[0].uses.size() == 1) << "nothing is declared for an absent input";
  EXPECT_EQ(Buffers::reason(plan, "shadow_blur"),
            "needs the shadow map, which no kept pass makes; shadow_map was left out: no light casts a shadow");
  EXPECT_EQ(
      Buffers::reason(plan, "fog"),
      "needs shadow_blur_out, which no kept pass makes; shadow_blur was left out: needs the shadow map, which no kept "
      "pass makes; shadow_map was left out: no light casts a shadow");
}

TEST(GraphPrune, AHandleWithoutAReasonNamesNoPass) {
  Buffers g;
  g.builder.leave_out("depth_prepass", "nothing is opaque");
  g.builder.leave_out("depth_pyramid", "culling is off");
  g.pass("ao", {{BufferHandle{}, "depth"}});
  g.pass("sky", {{BufferHandle{}, "stars"}});
  const FramePlan plan = compile_graph(g.builder).plan;
  EXPECT_EQ(Buffers::reason(plan, "ao"), "needs depth, which no kept pass makes");
  EXPECT_EQ(Buffers::reason(plan, "sky"), "needs stars, which no kept pass makes");
}

TEST(GraphPrune, AbsenceFlowsBackwardThroughALeftOutReader) {
  Buffers g;
  const BufferHandle list = g.pass("light_list", {});
  g.pass("shade", {{list, "light list"}, {BufferHandle{}, "depth"}});
  g.builder.sink(g.pass("unlit", {}));
  const FramePlan plan = compile_graph(g.builder).plan;
  EXPECT_EQ(Buffers::names(plan), "unlit");
  EXPECT_EQ(Buffers::reason(plan, "light_list"), "nothing reads light_list_out");
}

TEST(GraphPrune, WritingOntoAnAbsentImageLeavesThePassOut) {
  GraphBuilder builder;
  builder.begin_pass("sky");
  EXPECT_FALSE(builder.write(ImageHandle{}, Access::color_attachment));
  EXPECT_FALSE(builder.end_pass({}));
  EXPECT_EQ(builder.left_out()[0].reason, "needs an image to write to, which no kept pass makes");
  builder.sink(ImageHandle{});
  EXPECT_TRUE(builder.sinks().empty());
}

}  // namespace
}  // namespace candela
