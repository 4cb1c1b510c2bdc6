#include "graph/builder.h"

#include <gtest/gtest.h>

namespace candela::graph_builder {
namespace {

ImageDesc image_desc(std::string name, VkFormat format = VK_FORMAT_R16G16B16A16_SFLOAT, uint32_t samples = 1) {
  return {.name = std::move(name), .format = format, .width_px = 8, .height_px = 8, .samples = samples};
}
BufferDesc buffer_desc(std::string name) { return {.name = std::move(name), .size_bytes = 64}; }

// Runs it, and wants a GraphError whose text holds every one of the parts.
template <class F>
void expect_refused(F f, std::initializer_list<const char*> parts) {
  try {
    f();
    ADD_FAILURE() << "not refused; expected " << *parts.begin();
  } catch (const GraphError& error) {
    for (const char* part : parts) EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

class GraphBuilderTest : public testing::Test {
 protected:
  void SetUp() override {
    scene = builder.import_buffer(buffer_desc("scene"));
    builder.begin_pass("first");
    color_0 = builder.create(image_desc("color"));
    color = builder.write(color_0, Access::color_attachment);
    depth = builder.write(builder.create(image_desc("depth", VK_FORMAT_D32_SFLOAT)), Access::depth_attachment);
    list = builder.write(builder.create(buffer_desc("list")), Access::compute_write);
    builder.end_pass({});
    builder.begin_pass("second");
  }
  GraphBuilder builder;
  ImageHandle color_0, color, depth;
  BufferHandle scene, list;
};

TEST_F(GraphBuilderTest, RefusesStaleHandles) {
  expect_refused([&] { builder.read(color_0, Access::sampled_fragment, "color"); }, {"second", "color", "stale"});
  expect_refused([&] { builder.write(color_0, Access::color_attachment); }, {"second", "color", "stale"});
  expect_refused([&] { builder.read_optional(color_0, Access::sampled_fragment); }, {"color", "stale"});
  expect_refused([&] { builder.sink(color_0); }, {"color", "stale"});
}

// A cycle needs a pass that reads what a later one writes; its handle does not exist yet, and the one it has goes stale
// when the later pass writes. So it cannot be declared.
TEST_F(GraphBuilderTest, ACycleCannotBeDeclared) {
  builder.read(color, Access::sampled_compute, "color");
  const BufferHandle exposure = builder.write(builder.create(buffer_desc("exposure")), Access::compute_write);
  builder.end_pass({});
  builder.begin_pass("third");
  builder.read(exposure, Access::fragment_read, "exposure");
  builder.write(color, Access::color_attachment);
  builder.end_pass({});
  builder.begin_pass("fourth");
  expect_refused([&] { builder.read(color, Access::sampled_compute, "color"); }, {"fourth", "color", "stale"});
  expect_refused(
      [&] {
        builder.read(ImageHandle{color.resource, 3}, Access::sampled_compute, "color");
      },
      {"fourth", "color", "stale"});
}

TEST_F(GraphBuilderTest, RefusesForeignHandles) {
  expect_refused([&] { builder.read(ImageHandle{99, 1}, Access::sampled_fragment, "x"); }, {"second", "another graph"});
  expect_refused(
      [&] {
        builder.read(BufferHandle{color.resource, 1}, Access::compute_read, "x");
      },
      {"color", "another graph"});
}

TEST_F(GraphBuilderTest, RefusesReadsOfTheUnwritten) {
  const ImageHandle empty = builder.create(image_desc("empty"));
  expect_refused([&] { builder.read(empty, Access::sampled_fragment, "empty"); },
                 {"second", "empty", "before anything was written"});
  expect_refused([&] { builder.write(empty, Access::storage_image_read_write); },
                 {"empty", "before anything was written"});
  const BufferHandle nothing = builder.create(buffer_desc("nothing"));
  expect_refused([&] { builder.read(nothing, Access::compute_read, "nothing"); },
                 {"nothing", "before anything was written"});
  expect_refused([&] { builder.sink(nothing); }, {"nothing", "nothing writes"});
  BufferDesc zeros = buffer_desc("zeros");
  zeros.zeroed = true;
  EXPECT_NO_THROW(builder.read(builder.create(zeros), Access::compute_read, "zeros"));
}

TEST_F(GraphBuilderTest, RefusesWritesOfImports) {
  expect_refused([&] { builder.write(scene, Access::compute_write); }, {"second", "scene", "imported"});
}

TEST_F(GraphBuilderTest, RefusesAccessesThatDoNotFit) {
  expect_refused([&] { builder.read(color, Access::color_attachment, "color"); },
                 {"second", "color", "color_attachment", "writes"});
  expect_refused([&] { builder.write(color, Access::sampled_compute); }, {"color", "sampled_compute", "only reads"});
  expect_refused([&] { builder.read(color, Access::index_read, "color"); }, {"color", "index_read", "image"});
  expect_refused([&] { builder.read(list, Access::sampled_compute, "list"); }, {"list", "sampled_compute", "buffer"});
  expect_refused([&] { builder.read(list, Access::host_read, "list"); }, {"list", "sink"});
  expect_refused([&] { builder.write(color, Access::depth_attachment); }, {"color", "format"});
  expect_refused([&] { builder.write(depth, Access::color_attachment); }, {"depth", "format"});
  expect_refused([&] { builder.write(depth, Access::storage_image_write); }, {"depth", "format"});
  expect_refused(
      [&] { builder.write(builder.create(image_desc("ms", VK_FORMAT_R8_UNORM, 4)), Access::resolve_attachment); },
      {"ms", "multisampled"});
}

TEST_F(GraphBuilderTest, RefusesEmptySizes) {
  expect_refused([&] { builder.create(BufferDesc{"none", 0}); }, {"second", "none"});
  expect_refused([&] { builder.create(ImageDesc{.name = "none", .format = VK_FORMAT_R8_UNORM}); }, {"second", "none"});
}

TEST_F(GraphBuilderTest, RefusesTwoLayoutsInOnePass) {
  builder.read(color, Access::sampled_fragment, "color");
  expect_refused([&] { builder.write(color, Access::color_attachment); },
                 {"second", "color", "sampled_fragment", "color_attachment"});
  expect_refused([&] { builder.read(color, Access::transfer_source, "color"); },
                 {"color", "sampled_fragment", "transfer_source"});
  builder.read(depth, Access::depth_test, "depth");
  EXPECT_NO_THROW(builder.read(depth, Access::sampled_fragment, "depth")) << "one read-only layout serves both";
  expect_refused([&] { builder.write(depth, Access::depth_attachment); }, {"depth", "depth_test", "depth_attachment"});
}

TEST_F(GraphBuilderTest, RefusesOrderInsideOnePass) {
  const BufferHandle written = builder.write(list, Access::compute_write);
  expect_refused([&] { builder.read(written, Access::indirect_read, "list"); }, {"second", "list", "split the pass"});
  expect_refused([&] { builder.write(written, Access::compute_write); }, {"second", "list", "twice"});
}

TEST_F(GraphBuilderTest, RefusesUseOutsideAPass) {
  expect_refused([&] { builder.begin_pass("inner"); }, {"inner", "second"});
  expect_refused([&] { builder.leave_out("inner", "because"); }, {"inner", "second"});
  expect_refused([&] { compile_graph(builder); }, {"second", "not ended"});
  builder.end_pass({});
  expect_refused([&] { builder.create(buffer_desc("late")); }, {"late", "outside a pass"});
  expect_refused([&] { builder.read(color, Access::sampled_fragment, "color"); }, {"color", "outside a pass"});
  expect_refused([&] { builder.read_optional(color, Access::sampled_fragment); }, {"outside a pass"});
  expect_refused([&] { builder.write(color, Access::color_attachment); }, {"outside a pass"});
  expect_refused([&] { builder.pipeline(ComputePipelineDesc{"a.comp", {}}); }, {"outside a pass"});
  expect_refused([&] { builder.end_pass({}); }, {"outside a pass"});
}

TEST_F(GraphBuilderTest, ALeftOutPassLeavesNothingBehind) {
  const ImageHandle newer = builder.write(color, Access::color_attachment);
  const ImageHandle own = builder.write(builder.create(image_desc("own")), Access::color_attachment);
  builder.pipeline(ComputePipelineDesc{"own.comp", {}});
  builder.sink(own);
  builder.read(BufferHandle{}, Access::fragment_read, "lights");
  builder.create(BufferDesc{"sized by what is missing", 0});
  EXPECT_FALSE(builder.end_pass({}));
  ASSERT_EQ(builder.left_out().size(), 1u);
  EXPECT_EQ(builder.left_out()[0].pass, "second");
  EXPECT_EQ(builder.left_out()[0].reason, "needs lights, which no kept pass makes");
  EXPECT_EQ(builder.passes().size(), 1u);
  EXPECT_TRUE(builder.sinks().empty());

  builder.begin_pass("third");
  expect_refused([&] { builder.read(own, Access::sampled_fragment, "own"); }, {"third", "own", "second", "left out"});
  expect_refused([&] { builder.read(newer, Access::sampled_fragment, "color"); }, {"third", "color", "stale"});
  EXPECT_NO_THROW(builder.read(color, Access::sampled_fragment, "color")) << "the version before is the newest again";
  builder.sink(builder.write(builder.create(image_desc("out")), Access::color_attachment));
  EXPECT_TRUE(builder.end_pass({}));
  const FramePlan plan = compile_graph(builder).plan;
  EXPECT_TRUE(plan.pipelines.empty());
  EXPECT_EQ(plan.resources[own.resource].first_pass, -1);
}

TEST_F(GraphBuilderTest, PipelinesAreMergedAndKnownByTheirPass) {
  const PipelineHandle a = builder.pipeline(ComputePipelineDesc{"dropped.comp", {}});
  EXPECT_EQ(a.index, 0);
  builder.write(builder.create(buffer_desc("unread")), Access::compute_write);
  builder.end_pass({});
  for (const char* name : {"third", "fourth"}) {
    builder.begin_pass(name);
    EXPECT_EQ(builder.pipeline(ComputePipelineDesc{"shared.comp", {{0, "X", 1}}}).index, 0);
    EXPECT_EQ(builder.pipeline(ComputePipelineDesc{"shared.comp", {{0, "X", uint32_t(name[0] == 'f' ? 2 : 3)}}}).index,
              1);
    builder.sink(builder.write(builder.create(buffer_desc(name)), Access::compute_write));
    builder.end_pass({});
  }
  const FramePlan plan = compile_graph(builder).plan;
  ASSERT_EQ(plan.passes.size(), 2u);
  EXPECT_EQ(plan.pipelines.size(), 3u) << "the pruned pass's is gone, the shared one is one";
  EXPECT_EQ(plan.passes[0].pipelines, (std::vector<int>{0, 1}));
  EXPECT_EQ(plan.passes[1].pipelines, (std::vector<int>{0, 2}));
}

TEST_F(GraphBuilderTest, RecordingClosuresFollowTheirPasses) {
  builder.end_pass({});  // writes nothing
  builder.begin_pass("third");
  builder.sink(builder.write(builder.create(buffer_desc("out")), Access::compute_write));
  builder.end_pass([](CommandList&) {});
  const CompiledGraph graph = compile_graph(builder);
  ASSERT_EQ(graph.plan.passes.size(), 1u);
  ASSERT_EQ(graph.record.size(), 1u);
  EXPECT_TRUE(graph.record[0]);
  EXPECT_EQ(graph.plan.passes[0].declared, 2);
}

TEST(GraphInstances, ASecondPassOfOneNameIsRefused) {
  GraphBuilder builder;
  builder.begin_pass("blur");
  builder.end_pass({});
  EXPECT_THROW(builder.begin_pass("blur"), GraphError);
  builder.begin_pass("blur.wide");
  builder.knob("blur.radius", "3");
  builder.sink(builder.write(builder.create(BufferDesc{"out", 4}), Access::compute_write));
  builder.end_pass({});
  const FramePlan plan = compile_graph(builder).plan;
  ASSERT_EQ(plan.passes.size(), 1u);
  EXPECT_EQ(plan.passes[0].pass(), "blur");
  EXPECT_EQ(plan_knobs(plan), (std::vector<PlanKnob>{{"blur.radius", "3"}}));
}

}  // namespace
}  // namespace candela::graph_builder
