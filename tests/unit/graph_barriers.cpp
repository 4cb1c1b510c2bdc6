#include <gtest/gtest.h>

#include "graph_hazards.h"
#include "graph_random.h"

namespace candela::graph_barriers {
namespace {

constexpr ImageDesc color{.name = {}, .format = VK_FORMAT_R16G16B16A16_SFLOAT, .width_px = 64, .height_px = 64};

ImageDesc named(std::string name) {
  ImageDesc desc = color;
  desc.name = std::move(name);
  return desc;
}

// A compute pass that reads and writes what it is given; most of the tests are chains of these.
struct Chain {
  GraphBuilder builder;
  BufferHandle buffer;
  void begin(const char* name) { builder.begin_pass(name); }
  void end() { builder.end_pass({}); }
  FramePlan plan() { return compile_graph(builder).plan; }
};

TEST(GraphBarriers, ReadAfterWriteOfABuffer) {
  Chain c;
  c.begin("make");
  c.buffer = c.builder.write(c.builder.create(BufferDesc{"b", 64}), Access::compute_write);
  c.end();
  c.begin("use");
  c.builder.read(c.buffer, Access::indirect_read, "b");
  c.builder.sink(c.builder.write(c.builder.create(BufferDesc{"out", 64}), Access::fragment_write));
  c.end();
  const FramePlan plan = c.plan();
  EXPECT_TRUE(plan.passes[0].barriers.empty()) << "nothing came before";
  const PassBarriers& b = plan.passes[1].barriers;
  EXPECT_EQ(b.source_stages, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
  EXPECT_EQ(b.source_access, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
  EXPECT_EQ(b.destination_stages, VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT);
  EXPECT_EQ(b.destination_access, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT);
  EXPECT_TRUE(b.images.empty());
}

TEST(GraphBarriers, WriteAfterReadWaitsForExecutionAlone) {
  Chain c;
  c.begin("make");
  c.buffer = c.builder.write(c.builder.create(BufferDesc{"b", 64}), Access::transfer_destination);
  c.end();
  c.begin("use");
  c.builder.read(c.buffer, Access::vertex_read, "b");
  const BufferHandle out = c.builder.write(c.builder.create(BufferDesc{"out", 64}), Access::fragment_write);
  c.builder.sink(out);
  c.end();
  c.begin("overwrite");
  c.builder.sink(c.builder.write(c.buffer, Access::transfer_destination));
  c.end();
  const PassBarriers& b = c.plan().passes[2].barriers;
  EXPECT_EQ(b.source_stages, VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT);
  EXPECT_EQ(b.source_access, 0u);
  EXPECT_EQ(b.destination_stages, VK_PIPELINE_STAGE_2_TRANSFER_BIT);
  EXPECT_EQ(b.destination_access, 0u);
}

TEST(GraphBarriers, SecondReadInTheSameStageNeedsNone) {
  Chain c;
  c.begin("make");
  ImageHandle image = c.builder.write(c.builder.create(named("i")), Access::color_attachment);
  c.end();
  for (const char* name : {"first", "second"}) {
    c.begin(name);
    c.builder.read(image, Access::sampled_compute, "i");
    c.builder.sink(c.builder.write(c.builder.create(BufferDesc{name, 64}), Access::compute_write));
    c.end();
  }
  c.begin("other stage");
  c.builder.read(image, Access::sampled_fragment, "i");
  c.builder.sink(c.builder.write(c.builder.create(BufferDesc{"o", 64}), Access::fragment_write));
  c.end();
  const FramePlan plan = c.plan();
  ASSERT_EQ(plan.passes[1].barriers.images.size(), 1u);
  EXPECT_EQ(plan.passes[1].barriers.images[0].old_layout, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
  EXPECT_EQ(plan.passes[1].barriers.images[0].new_layout, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  EXPECT_TRUE(plan.passes[2].barriers.empty());
  EXPECT_TRUE(plan.passes[3].barriers.images.empty());
  EXPECT_EQ(plan.passes[3].barriers.source_stages, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT) << "after the layout change";
  EXPECT_EQ(plan.passes[3].barriers.destination_stages, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT);
}

TEST(GraphBarriers, ABarrierForOneResourceSparesAnother) {
  Chain c;
  BufferHandle made[2];
  for (int i = 0; i < 2; ++i) {
    c.begin(i ? "make b" : "make a");
    made[i] = c.builder.write(c.builder.create(BufferDesc{"b", 64}), Access::compute_write);
    c.end();
  }
  for (int i = 0; i < 2; ++i) {
    c.begin(i ? "use b" : "use a");
    c.builder.read(made[i], Access::fragment_read, "b");
    c.builder.sink(c.builder.write(c.builder.create(BufferDesc{"o", 64}), Access::fragment_write));
    c.end();
  }
  const FramePlan plan = c.plan();
  EXPECT_FALSE(plan.passes[2].barriers.empty());
  EXPECT_TRUE(plan.passes[3].barriers.empty());
}

TEST(GraphBarriers, ZeroedBufferStartsFromTheFill) {
  Chain c;
  c.begin("count");
  c.builder.sink(c.builder.write(c.builder.create(BufferDesc{.name = "n", .size_bytes = 4, .zeroed = true}),
                                 Access::compute_write));
  c.end();
  const FramePlan plan = c.plan();
  const PassBarriers& b = plan.passes[0].barriers;
  EXPECT_EQ(b.source_stages, VK_PIPELINE_STAGE_2_TRANSFER_BIT);
  EXPECT_EQ(b.source_access, VK_ACCESS_2_TRANSFER_WRITE_BIT);
  EXPECT_EQ(b.destination_stages, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
  EXPECT_TRUE(plan.resources[0].buffer_usage & VK_BUFFER_USAGE_TRANSFER_DST_BIT);
}

TEST(GraphBarriers, ImportedBuffersNeedNone) {
  Chain c;
  const BufferHandle scene = c.builder.import_buffer({"scene", 64});
  c.begin("use");
  c.builder.read(scene, Access::compute_read, "scene");
  c.builder.sink(c.builder.write(c.builder.create(BufferDesc{"o", 64}), Access::compute_write));
  c.end();
  EXPECT_TRUE(c.plan().passes[0].barriers.empty());
}

TEST(GraphBarriers, ReadbackEndsAtTheHost) {
  Chain c;
  c.begin("copy");
  c.builder.sink(
      c.builder.write(c.builder.create(BufferDesc{"r", 64, BufferMemory::host_read}), Access::transfer_destination));
  c.end();
  const PassBarriers b = c.plan().final_barriers;
  EXPECT_EQ(b.source_stages, VK_PIPELINE_STAGE_2_TRANSFER_BIT);
  EXPECT_EQ(b.source_access, VK_ACCESS_2_TRANSFER_WRITE_BIT);
  EXPECT_EQ(b.destination_stages, VK_PIPELINE_STAGE_2_HOST_BIT);
  EXPECT_EQ(b.destination_access, VK_ACCESS_2_HOST_READ_BIT);
}

TEST(GraphBarriers, DepthTestedAndSampledInOnePassKeepsOneLayout) {
  Chain c;
  ImageDesc desc = named("depth");
  desc.format = VK_FORMAT_D32_SFLOAT;
  c.begin("prepass");
  const ImageHandle depth = c.builder.write(c.builder.create(desc), Access::depth_attachment);
  c.end();
  c.begin("shade");
  c.builder.read(depth, Access::depth_test, "depth");
  c.builder.read(depth, Access::sampled_fragment, "depth");
  const ImageHandle out = c.builder.write(c.builder.create(named("color")), Access::color_attachment);
  c.builder.sink(out);
  c.end();
  const FramePlan plan = c.plan();
  ASSERT_EQ(plan.passes[1].barriers.images.size(), 2u);
  const ImageBarrier& b = plan.passes[1].barriers.images[0];
  EXPECT_EQ(b.new_layout, VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL);
  EXPECT_TRUE(b.destination_stages & VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT);
  EXPECT_TRUE(b.destination_stages & VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT);
  EXPECT_TRUE(test::find_hazards(plan).empty());
}

TEST(GraphBarriers, AliasedSuccessorWaitsForThePredecessor) {
  Chain c;
  ImageHandle image;
  for (const char* name : {"a", "b", "c"}) {
    c.begin(name);
    if (image) c.builder.read(image, Access::sampled_compute, "previous");
    image = c.builder.write(c.builder.create(named(name)), Access::storage_image_write);
    c.end();
  }
  c.builder.sink(image);
  const FramePlan plan = c.plan();
  ASSERT_EQ(plan.resources[0].block, plan.resources[2].block);
  const ImageBarrier& b = plan.passes[2].barriers.images[1];
  EXPECT_EQ(b.resource, 2);
  EXPECT_EQ(b.old_layout, VK_IMAGE_LAYOUT_UNDEFINED);
  EXPECT_EQ(b.source_stages, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
  EXPECT_EQ(plan.passes[0].barriers.images[0].source_stages, 0u) << "the first owner of the block waits for nobody";
}

TEST(GraphBarriers, RandomGraphsHaveNoHazard) {
  size_t passes = 0, shared_blocks = 0;
  for (uint32_t seed = 0; seed < 600; ++seed) {
    const FramePlan plan = test::RandomGraph(seed).compiled().plan;
    const std::vector<std::string> hazards = test::find_hazards(plan);
    ASSERT_TRUE(hazards.empty()) << "seed " << seed << ": " << hazards[0] << "\n" << plan_text(plan);
    passes += plan.passes.size();
    size_t images = 0;
    for (const PlanResource& r : plan.resources) images += r.block >= 0;
    shared_blocks += images - plan.block_bytes.size();
  }
  EXPECT_GT(passes, 1500u);
  EXPECT_GT(shared_blocks, 300u) << "the random graphs must exercise aliasing";
}

// The checker itself: every dropped or narrowed barrier is a hazard. The walk knows less than the checker about
// execution chains through other resources' barriers, so a few barriers of random graphs are more than needed.
TEST(GraphBarriers, EveryDroppedBarrierIsCaught) {
  size_t dropped = 0, caught = 0, images_dropped = 0, images_caught = 0, last_dropped = 0, last_caught = 0;
  for (uint32_t seed = 0; seed < 80; ++seed) {
    const FramePlan plan = test::RandomGraph(seed).compiled().plan;
    std::vector<std::pair<size_t, size_t>> places;  // pass, step
    for (size_t p = 0; p < plan.passes.size(); ++p)
      for (size_t step = 0; step < plan.passes[p].steps(); ++step) places.emplace_back(p, step);
    places.emplace_back(plan.passes.size(), 0);
    for (const auto& place : places) {
      const auto barriers = [&](FramePlan& of) -> PassBarriers& {
        if (place.first == of.passes.size()) return of.final_barriers;
        PlanPass& pass = of.passes[place.first];
        return place.second ? pass.step_barriers[place.second - 1] : pass.barriers;
      };
      FramePlan mutant = plan;
      if (barriers(mutant).source_stages != 0) {
        barriers(mutant).source_stages = 0;
        ++dropped, caught += !test::find_hazards(mutant).empty();
      }
      for (size_t i = 0; i < barriers(mutant = plan).images.size(); ++i) {
        barriers(mutant = plan).images.erase(barriers(mutant).images.begin() + long(i));
        const bool is_caught = !test::find_hazards(mutant).empty();
        if (place.first == plan.passes.size())
          ++last_dropped, last_caught += is_caught;
        else
          ++images_dropped, images_caught += is_caught;
      }
    }
  }
  EXPECT_EQ(images_caught, images_dropped);
  EXPECT_GT(images_dropped, 400u);
  // At the end a few wait for what a chain of barriers has made visible.
  EXPECT_GT(last_dropped, 50u);
  EXPECT_GE(double(last_caught), 0.95 * double(last_dropped)) << last_caught << " of " << last_dropped;
  EXPECT_GT(dropped, 200u);
  EXPECT_GE(double(caught), 0.95 * double(dropped)) << caught << " of " << dropped;
}

TEST(GraphBarriers, ALostTakeoverOfAliasedMemoryIsCaught) {
  size_t lost = 0;
  for (uint32_t seed = 0; seed < 150; ++seed) {
    const FramePlan plan = test::RandomGraph(seed).compiled().plan;
    for (size_t p = 0; p < plan.passes.size(); ++p)
      for (size_t i = 0; i < plan.passes[p].barriers.images.size(); ++i) {
        FramePlan mutant = plan;
        ImageBarrier& b = mutant.passes[p].barriers.images[i];
        if (b.old_layout != VK_IMAGE_LAYOUT_UNDEFINED || b.source_stages == 0) continue;
        b.source_stages = 0, b.source_access = 0;
        ++lost;
        EXPECT_FALSE(test::find_hazards(mutant).empty()) << "seed " << seed << ", pass " << p;
      }
  }
  EXPECT_GT(lost, 50u);
}

}  // namespace
}  // namespace candela::graph_barriers
