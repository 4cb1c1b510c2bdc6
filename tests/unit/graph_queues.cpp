#include <gtest/gtest.h>

#include "graph/queues.h"
#include "graph_hazards.h"
#include "graph_random.h"

namespace candela::graph_queues {
namespace {

using Passes = std::vector<int>;

ImageDesc named(std::string name) {
  return {.name = std::move(name), .format = VK_FORMAT_R16G16B16A16_SFLOAT, .width_px = 64, .height_px = 64};
}

// Passes that write a buffer of their own and read those of others.
struct Chain {
  GraphBuilder builder;
  BufferHandle pass(const std::string& name, Queue queue, std::vector<BufferHandle> reads = {}) {
    builder.begin_pass(name, queue);
    for (const BufferHandle read : reads) builder.read(read, Access::compute_read, "input");
    const BufferHandle made =
        builder.write(builder.create(BufferDesc{.name = name, .size_bytes = 64}), Access::compute_write);
    builder.end_pass({});
    return made;
  }
  FramePlan plan(BufferHandle sink) {
    builder.sink(sink);
    return compile_graph(builder).plan;
  }
};

TEST(GraphQueues, OneQueueHasNoBatches) {
  Chain c;
  const BufferHandle a = c.pass("a", Queue::main), b = c.pass("b", Queue::main, {a});
  const FramePlan plan = c.plan(b);
  EXPECT_TRUE(plan.batches.empty());
  EXPECT_EQ(plan_text(plan).find("batches"), std::string::npos);
}

TEST(GraphQueues, APassWaitsForThePassThatItReads) {
  Chain c;
  const BufferHandle a = c.pass("a", Queue::main), b = c.pass("b", Queue::main, {a}),
                     side = c.pass("side", Queue::compute, {a}), d = c.pass("d", Queue::main, {b}),
                     e = c.pass("e", Queue::main, {d, side});
  const FramePlan plan = c.plan(e);
  ASSERT_EQ(plan.batches.size(), 4u);
  EXPECT_EQ(plan.batches[0].passes, Passes({0})) << "ends where the compute queue waits for it";
  EXPECT_EQ(plan.batches[1].passes, Passes({1, 3}));
  EXPECT_EQ(plan.batches[1].waits, Passes());
  EXPECT_EQ(plan.batches[2].queue, Queue::compute);
  EXPECT_EQ(plan.batches[2].passes, Passes({2}));
  EXPECT_EQ(plan.batches[2].waits, Passes({0}));
  EXPECT_EQ(plan.batches[3].passes, Passes({4}));
  EXPECT_EQ(plan.batches[3].waits, Passes({2}));
  EXPECT_NE(plan_text(plan).find("batches\n"), std::string::npos);
  EXPECT_NE(plan_json(plan).find("\"batches\""), std::string::npos);

  const PassOrder order(plan);
  EXPECT_TRUE(order.before(0, 2));
  EXPECT_FALSE(order.before(1, 2));
  EXPECT_FALSE(order.before(2, 1));
  EXPECT_FALSE(order.before(2, 3));
  EXPECT_TRUE(order.before(2, 4));
  EXPECT_TRUE(order.before(0, 4));

  using Orders = std::vector<Passes>;
  EXPECT_EQ(batch_orders(plan, 10), Orders({{0, 1, 2, 3}, {0, 2, 1, 3}}));
  EXPECT_EQ(batch_orders(plan, 1), Orders({{0, 1, 2, 3}}));
}

TEST(GraphQueues, AWaitThatAnotherCoversIsLeftOut) {
  Chain c;
  const BufferHandle a = c.pass("a", Queue::main), b = c.pass("b", Queue::main),
                     d = c.pass("d", Queue::compute, {a, b}), e = c.pass("e", Queue::compute, {a, d});
  const FramePlan plan = c.plan(e);
  ASSERT_EQ(plan.batches.size(), 2u);
  EXPECT_EQ(plan.batches[0].passes, Passes({0, 1}));
  EXPECT_EQ(plan.batches[1].passes, Passes({2, 3}));
  EXPECT_EQ(plan.batches[1].waits, Passes({0}));
}

TEST(GraphQueues, AWriteWaitsForTheReadersOfTheOtherQueue) {
  GraphBuilder builder;
  builder.begin_pass("make");
  BufferHandle buffer = builder.write(builder.create(BufferDesc{.name = "b", .size_bytes = 64}), Access::compute_write);
  builder.end_pass({});
  builder.begin_pass("read", Queue::compute);
  builder.read(buffer, Access::compute_read, "b");
  const BufferHandle made =
      builder.write(builder.create(BufferDesc{.name = "c", .size_bytes = 64}), Access::compute_write);
  builder.end_pass({});
  builder.begin_pass("overwrite");
  buffer = builder.write(buffer, Access::compute_write);
  builder.end_pass({});
  builder.sink(buffer);
  builder.sink(made);
  FramePlan plan = compile_graph(builder).plan;
  ASSERT_EQ(plan.batches.size(), 3u);
  EXPECT_EQ(plan.batches[2].waits, Passes({1}));
  EXPECT_TRUE(test::find_hazards(plan).empty());
  plan.batches[2].waits.clear();
  EXPECT_FALSE(test::find_hazards(plan).empty());
}

// Two readers on two queues: the one that changes the layout is a writer to the other.
TEST(GraphQueues, AChangeOfLayoutIsWaitedFor) {
  GraphBuilder builder;
  builder.begin_pass("make");
  const ImageHandle image = builder.write(builder.create(named("image")), Access::storage_image_write);
  builder.end_pass({});
  for (const Queue queue : {Queue::main, Queue::compute}) {
    builder.begin_pass(queue == Queue::main ? "here" : "there", queue);
    builder.read(image, Access::sampled_compute, "image");
    builder.sink(builder.write(builder.create(BufferDesc{.name = "made", .size_bytes = 64}), Access::compute_write));
    builder.end_pass({});
  }
  FramePlan plan = compile_graph(builder).plan;
  ASSERT_EQ(plan.batches.size(), 2u);
  EXPECT_EQ(plan.batches[1].waits, Passes({0}));
  EXPECT_TRUE(plan.resources[0].both_queues);
  EXPECT_TRUE(plan.passes[2].barriers.images.empty());
  EXPECT_TRUE(test::find_hazards(plan).empty());
  plan.batches[1].waits.clear();
  EXPECT_FALSE(test::find_hazards(plan).empty());
}

// Images that follow one another on one queue share memory; on two queues without an order between they do not.
TEST(GraphQueues, MemoryIsSharedOnlyWhereThePartialOrderAllowsIt) {
  for (const Queue other : {Queue::main, Queue::compute}) {
    GraphBuilder builder;
    std::vector<ImageHandle> images;
    for (const Queue queue : {Queue::main, other}) {
      const std::string name = images.empty() ? "first" : "second";
      builder.begin_pass("make " + name, queue);
      const ImageHandle image = builder.write(builder.create(named("image")), Access::storage_image_write);
      builder.end_pass({});
      builder.begin_pass("use " + name, queue);
      builder.read(image, Access::sampled_compute, "image");
      builder.sink(builder.write(builder.create(BufferDesc{.name = "made", .size_bytes = 64}), Access::compute_write));
      builder.end_pass({});
      images.push_back(image);
    }
    FramePlan plan = compile_graph(builder).plan;
    const int first = plan.resources[size_t(images[0].resource)].block;
    int& second = plan.resources[size_t(images[1].resource)].block;
    EXPECT_EQ(first == second, other == Queue::main);
    EXPECT_TRUE(test::find_hazards(plan).empty());
    if (other == Queue::main) continue;
    second = first;
    EXPECT_FALSE(test::find_hazards(plan).empty());
  }
}

TEST(GraphQueues, ADrawOnTheComputeQueueIsRefused) {
  const auto refused = [](auto declare) {
    GraphBuilder builder;
    builder.begin_pass("make");
    const ImageHandle depth = builder.write(
        builder.create(ImageDesc{.name = "depth", .format = VK_FORMAT_D32_SFLOAT, .width_px = 4, .height_px = 4}),
        Access::depth_attachment);
    builder.end_pass({});
    builder.begin_pass("aside", Queue::compute);
    try {
      declare(builder, depth);
    } catch (const GraphError& error) {
      return std::string(error.what()).find("compute queue") != std::string::npos;
    }
    return false;
  };
  EXPECT_TRUE(refused([](GraphBuilder& b, ImageHandle) { b.write(b.create(named("c")), Access::color_attachment); }));
  EXPECT_TRUE(refused([](GraphBuilder& b, ImageHandle d) { b.read(d, Access::sampled_fragment, "depth"); }));
  EXPECT_TRUE(refused([](GraphBuilder& b, ImageHandle d) { b.read(d, Access::transfer_source, "depth"); }));
  EXPECT_TRUE(refused([](GraphBuilder& b, ImageHandle) { b.pipeline(GraphicsPipelineDesc{.vertex_shader = "v"}); }));
  EXPECT_FALSE(refused([](GraphBuilder& b, ImageHandle d) { b.read(d, Access::sampled_compute, "depth"); }));
}

TEST(GraphQueues, RandomGraphsHaveNoHazard) {
  size_t batches = 0, waits = 0, shared_blocks = 0;
  for (uint32_t seed = 0; seed < 400; ++seed) {
    const FramePlan plan = test::RandomGraph(seed, 2).compiled().plan;
    const std::vector<std::string> hazards = test::find_hazards(plan);
    ASSERT_TRUE(hazards.empty()) << "seed " << seed << ": " << hazards[0] << "\n" << plan_text(plan);
    batches += plan.batches.size();
    for (const QueueBatch& batch : plan.batches) waits += batch.waits.size();
    size_t images = 0;
    for (const PlanResource& r : plan.resources) images += r.block >= 0;
    shared_blocks += images - plan.block_bytes.size();
    for (const std::vector<int>& order : batch_orders(plan, 20)) ASSERT_EQ(order.size(), plan.batches.size());
  }
  EXPECT_GT(batches, 1000u);
  EXPECT_GT(waits, 600u);
  EXPECT_GT(shared_blocks, 50u) << "the random graphs must exercise aliasing";
}

// The checker itself, and that no batch waits in vain: every dropped wait is a hazard, and so is one for a batch too
// early.
TEST(GraphQueues, EveryDroppedWaitIsCaught) {
  size_t dropped = 0, images_dropped = 0;
  for (uint32_t seed = 0; seed < 150; ++seed) {
    const FramePlan plan = test::RandomGraph(seed, 2).compiled().plan;
    for (size_t b = 0; b < plan.batches.size(); ++b) {
      if (plan.batches[b].waits.empty()) continue;
      FramePlan mutant = plan;
      mutant.batches[b].waits.clear();
      ++dropped;
      EXPECT_FALSE(test::find_hazards(mutant).empty()) << "seed " << seed << ", batch " << b;
    }
    for (size_t p = 0; p < plan.passes.size(); ++p)
      for (size_t i = 0; i < plan.passes[p].barriers.images.size(); ++i) {
        FramePlan mutant = plan;
        std::vector<ImageBarrier>& images = mutant.passes[p].barriers.images;
        images.erase(images.begin() + long(i));
        ++images_dropped;
        EXPECT_FALSE(test::find_hazards(mutant).empty()) << "seed " << seed << ", pass " << p;
      }
  }
  EXPECT_GT(dropped, 200u);
  EXPECT_GT(images_dropped, 300u);
}

}  // namespace
}  // namespace candela::graph_queues
