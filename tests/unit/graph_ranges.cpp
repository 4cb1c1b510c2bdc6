#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "graph_hazards.h"
#include "graph_random.h"

// Images of several subresources: what the builder refuses, what is pruned, where barriers stand, what plans print.
namespace candela::graph_ranges {
namespace {

ImageDesc chain_desc(std::string name, uint32_t mips = 4) {
  return {
      .name = std::move(name), .format = VK_FORMAT_R16G16B16A16_SFLOAT, .width_px = 16, .height_px = 8, .mips = mips};
}
ImageDesc cube_desc(std::string name) {
  ImageDesc desc = chain_desc(std::move(name), 1);
  desc.height_px = 16, desc.kind = ImageKind::cube, desc.layers = 6;
  return desc;
}

template <class F>
void expect_refused(F f, std::initializer_list<const char*> parts) {
  try {
    f();
    ADD_FAILURE() << "not refused; expected " << *parts.begin();
  } catch (const GraphError& error) {
    for (const char* part : parts) EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

// fill mip 0, halve in steps, use the last mip.
FramePlan chain_plan(uint32_t mips, const char* name = "chain", bool steps = true) {
  GraphBuilder builder;
  builder.begin_pass("fill");
  ImageHandle image =
      builder.write(builder.create(chain_desc(name, mips)), Access::color_attachment, ImageRange::mip(0));
  builder.end_pass({});
  if (steps) {
    builder.begin_pass("halve");
    for (uint32_t mip = 1; mip < mips; ++mip) {
      builder.begin_step();
      builder.read(image, Access::sampled_compute, "image", ImageRange::mip(mip - 1));
      image = builder.write(image, Access::storage_image_write, ImageRange::mip(mip));
    }
    builder.end_pass({});
  }
  builder.begin_pass("use");
  builder.read(image, Access::sampled_fragment, "image", steps ? ImageRange{} : ImageRange::mip(0));
  builder.sink(builder.write(builder.create(BufferDesc{"out", 64}), Access::fragment_write));
  builder.end_pass({});
  return compile_graph(builder).plan;
}

TEST(GraphRanges, ShapesThatCannotBeAreRefused) {
  GraphBuilder builder;
  builder.begin_pass("make");
  const auto refused = [&](ImageDesc desc, const char* why) {
    expect_refused([&] { builder.create(desc); }, {"make", "image", why});
  };
  ImageDesc desc = chain_desc("image", 6);
  refused(desc, "more mips");
  desc = cube_desc("image"), desc.layers = 5;
  refused(desc, "6 layers");
  desc = cube_desc("image"), desc.height_px = 8;
  refused(desc, "not square");
  desc = cube_desc("image"), desc.kind = ImageKind::cube_array, desc.layers = 8;
  refused(desc, "6 layers for each cube");
  desc = chain_desc("image"), desc.layers = 2;
  refused(desc, "neither an array nor a cube");
  desc = chain_desc("image"), desc.depth_px = 2;
  refused(desc, "not 3D");
  desc = chain_desc("image"), desc.samples = 4;
  refused(desc, "multisampled");
  desc = chain_desc("image"), desc.mips = 0;
  refused(desc, "without a texel");
}

TEST(GraphRanges, RangesAndViewsThatDoNotFitAreRefused) {
  GraphBuilder builder;
  builder.begin_pass("make");
  const ImageHandle chain = builder.create(chain_desc("chain"));
  expect_refused([&] { builder.write(chain, Access::storage_image_write, ImageRange::mip(4)); },
                 {"make", "chain", "4 mips and 1 layers"});
  expect_refused([&] { builder.write(chain, Access::color_attachment); }, {"chain", "4 mips", "range of one"});
  expect_refused([&] { builder.write(chain, Access::storage_image_write); }, {"chain", "range of one"});
  expect_refused([&] { builder.write(chain, Access::storage_image_write, ImageRange::mip(0), ImageKind::cube); },
                 {"chain", "as cube"});
  ImageDesc volume = chain_desc("volume", 1);
  volume.kind = ImageKind::d3, volume.depth_px = 4;
  expect_refused([&] { builder.write(builder.create(volume), Access::color_attachment); }, {"volume", "3D"});
  ImageHandle cube = builder.create(cube_desc("cube"));
  expect_refused([&] { builder.write(cube, Access::storage_image_write, {}, ImageKind::cube); }, {"cube", "as layers"});
  cube = builder.write(cube, Access::storage_image_write);
  builder.end_pass({});
  builder.begin_pass("use");
  expect_refused([&] { builder.read(cube, Access::sampled_compute, "cube", {}, ImageKind::d2); },
                 {"use", "cube", "several layers"});
  expect_refused([&] { builder.read(cube, Access::sampled_compute, "cube", ImageRange::layer(1), ImageKind::cube); },
                 {"cube", "6 layers"});
  builder.read(cube, Access::sampled_compute, "cube");
  EXPECT_EQ(builder.passes().back().uses.back().view, ImageKind::cube) << "seen as what it is";
  builder.read(cube, Access::sampled_compute, "cube", ImageRange::layer(1));
  EXPECT_EQ(builder.passes().back().uses.back().view, ImageKind::d2);
}

TEST(GraphRanges, OnlyWhatWasWrittenIsReadOrDrawnOnto) {
  GraphBuilder builder;
  builder.begin_pass("make");
  ImageHandle chain = builder.write(builder.create(chain_desc("chain")), Access::transfer_destination, {1, 2});
  ImageHandle cube = builder.write(builder.create(cube_desc("cube")), Access::color_attachment, ImageRange::layer(2));
  builder.end_pass({});
  builder.begin_pass("use");
  expect_refused([&] { builder.read(chain, Access::sampled_compute, "chain"); },
                 {"use", "chain", "before anything was written"});
  expect_refused([&] { builder.read(chain, Access::sampled_compute, "chain", ImageRange::mip(3)); },
                 {"chain[mip 3]", "before anything was written"});
  EXPECT_NO_THROW(builder.read(chain, Access::sampled_compute, "chain", {1, 2}));
  expect_refused([&] { builder.write(chain, Access::storage_image_read_write, ImageRange::mip(0)); },
                 {"chain[mip 0]", "storage_image_read_write"});
  expect_refused([&] { builder.write(cube, Access::color_attachment); }, {"cube", "only a part was written"});
  EXPECT_NO_THROW(cube = builder.write(cube, Access::color_attachment, ImageRange::layer(3)));
}

TEST(GraphRanges, OrderInsideAStepIsRefusedAndBetweenStepsIsNot) {
  GraphBuilder builder;
  expect_refused([&] { builder.begin_step(); }, {"begin_step outside a pass"});
  builder.begin_pass("make");
  ImageHandle chain =
      builder.write(builder.create(chain_desc("chain")), Access::storage_image_write, ImageRange::mip(0));
  expect_refused([&] { builder.read(chain, Access::sampled_compute, "chain", ImageRange::mip(0)); },
                 {"make", "chain", "split the pass"});
  EXPECT_NO_THROW(chain = builder.write(chain, Access::storage_image_write, ImageRange::mip(1))) << "another mip";
  builder.end_pass({});
  builder.begin_pass("use");
  const BufferHandle buffer = builder.write(builder.create(BufferDesc{"every step", 64}), Access::compute_write);
  for (const uint32_t mip : {2u, 3u}) {
    builder.begin_step();
    EXPECT_NO_THROW(builder.read(chain, Access::sampled_compute, "chain", ImageRange::mip(mip - 1)));
    EXPECT_NO_THROW(chain = builder.write(chain, Access::storage_image_write, ImageRange::mip(mip)));
    expect_refused([&] { builder.read(buffer, Access::compute_read, "b"); }, {"use", "every step", "split the pass"});
  }
  builder.sink(chain);
  builder.end_pass({});
  const FramePlan plan = compile_graph(builder).plan;
  ASSERT_EQ(plan.passes.size(), 2u);
  EXPECT_EQ(plan.passes[1].steps(), 2u);
  EXPECT_TRUE(test::find_hazards(plan).empty());
  EXPECT_NE(plan.passes[1].step_barriers[0].source_stages, 0u) << "both steps write the buffer";
}

TEST(GraphRanges, ALeftOutPassLeavesNoPartBehind) {
  GraphBuilder builder;
  builder.begin_pass("make");
  const ImageHandle chain =
      builder.write(builder.create(chain_desc("chain")), Access::storage_image_write, ImageRange::mip(0));
  builder.end_pass({});
  builder.begin_pass("left out");
  ImageHandle more = chain;
  for (uint32_t mip = 1; mip < 4; ++mip) more = builder.write(more, Access::storage_image_write, ImageRange::mip(mip));
  builder.read(BufferHandle{}, Access::compute_read, "lights");
  EXPECT_FALSE(builder.end_pass({}));
  builder.begin_pass("use");
  EXPECT_NO_THROW(builder.read(chain, Access::sampled_compute, "chain", ImageRange::mip(0)));
  expect_refused([&] { builder.read(chain, Access::sampled_compute, "chain", ImageRange::mip(1)); },
                 {"chain[mip 1]", "before anything was written"});
}

TEST(GraphRanges, OnlyTheWriterOfAWantedPartIsKept) {
  GraphBuilder builder;
  ImageHandle image;
  for (uint32_t mip = 0; mip < 3; ++mip) {
    builder.begin_pass(fmt::format("mip{}", mip));
    if (mip == 0) image = builder.create(chain_desc("chain"));
    image = builder.write(image, Access::storage_image_write, ImageRange::mip(mip));
    builder.end_pass({});
  }
  builder.begin_pass("use");
  builder.read(image, Access::sampled_compute, "image", ImageRange::mip(1));
  builder.sink(builder.write(builder.create(BufferDesc{"out", 64}), Access::compute_write));
  builder.end_pass({});
  const FramePlan plan = compile_graph(builder).plan;
  ASSERT_EQ(plan.passes.size(), 2u);
  EXPECT_EQ(plan.passes[0].name, "mip1");
  EXPECT_TRUE(plan.passes[0].uses[0].first);
  ASSERT_EQ(plan.left_out.size(), 2u);
  EXPECT_EQ(plan.left_out[0].reason, "nothing reads chain");
}

TEST(GraphRanges, EachStepHasItsOwnBarriers) {
  const FramePlan plan = chain_plan(4);
  ASSERT_EQ(plan.passes.size(), 3u);
  const PlanPass& halve = plan.passes[1];
  ASSERT_EQ(halve.steps(), 3u);
  for (uint32_t step = 0; step < 3; ++step) {
    const std::vector<ImageBarrier>& images = halve.barriers_before(step).images;
    ASSERT_EQ(images.size(), 2u) << step;
    EXPECT_EQ(images[0].range, (ImageRange{step, 1, 0, 1})) << "the mip that is read";
    EXPECT_EQ(images[0].old_layout, step ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    EXPECT_EQ(images[1].range, (ImageRange{step + 1, 1, 0, 1})) << "the mip that is written";
    EXPECT_EQ(images[1].old_layout, VK_IMAGE_LAYOUT_UNDEFINED);
  }
  const PassBarriers& use = plan.passes[2].barriers;
  ASSERT_EQ(use.images.size(), 1u) << "three mips are sampled already, one was written last";
  EXPECT_EQ(use.images[0].range, (ImageRange{3, 1, 0, 1}));
  EXPECT_EQ(use.destination_stages, VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT);
  EXPECT_TRUE(test::find_hazards(plan).empty());
}

TEST(GraphRanges, EqualNeighboursAreOneBarrier) {
  GraphBuilder builder;
  ImageDesc desc = cube_desc("cube");
  desc.mips = 3;
  builder.begin_pass("make");
  ImageHandle cube = builder.create(desc);
  for (uint32_t mip = 0; mip < 3; ++mip) cube = builder.write(cube, Access::storage_image_write, ImageRange::mip(mip));
  builder.end_pass({});
  builder.begin_pass("part");
  builder.read(cube, Access::sampled_compute, "cube", {0, 3, 2, 2});
  builder.sink(builder.write(builder.create(BufferDesc{"a", 64}), Access::compute_write));
  builder.end_pass({});
  builder.begin_pass("all");
  builder.read(cube, Access::sampled_compute, "cube");
  builder.sink(builder.write(builder.create(BufferDesc{"b", 64}), Access::compute_write));
  builder.end_pass({});
  const FramePlan plan = compile_graph(builder).plan;
  ASSERT_EQ(plan.passes[0].barriers.images.size(), 1u);
  EXPECT_EQ(plan.passes[0].barriers.images[0].range, (ImageRange{0, 3, 0, 6}));
  ASSERT_EQ(plan.passes[1].barriers.images.size(), 1u);
  EXPECT_EQ(plan.passes[1].barriers.images[0].range, (ImageRange{0, 3, 2, 2}));
  ASSERT_EQ(plan.passes[2].barriers.images.size(), 2u) << "the layers on both sides";
  EXPECT_EQ(plan.passes[2].barriers.images[0].range, (ImageRange{0, 3, 0, 2}));
  EXPECT_EQ(plan.passes[2].barriers.images[1].range, (ImageRange{0, 3, 4, 2}));
}

TEST(GraphRanges, AFilledImageIsSampledAndNeedsNoBarrier) {
  GraphBuilder builder;
  ImageDesc desc = cube_desc("sky");
  desc.mips = 3;
  const ImageHandle sky = builder.import_image(desc);
  builder.begin_pass("wrong");
  expect_refused([&] { builder.write(sky, Access::storage_image_write, ImageRange::mip(0)); }, {"sky", "imported"});
  builder.end_pass({});
  for (const Access access : {Access::sampled_compute, Access::sampled_fragment}) {
    builder.begin_pass(std::string(access_info(access).name));
    builder.read(sky, access, "sky");
    builder.sink(builder.write(builder.create(BufferDesc{"out", 64}), Access::compute_write));
    builder.end_pass({});
  }
  FramePlan plan = compile_graph(builder).plan;
  ASSERT_EQ(plan.passes.size(), 2u);
  for (const PlanPass& pass : plan.passes) EXPECT_TRUE(pass.barriers.images.empty());
  EXPECT_TRUE(plan.final_barriers.images.empty());
  EXPECT_TRUE(test::find_hazards(plan).empty());
  EXPECT_EQ(plan.resources[0].block, -1);
  EXPECT_EQ(transient_bytes(plan), 128u) << "the two buffers";
  // One mip copied away: back to how it was found.
  builder.begin_pass("copy");
  builder.read(sky, Access::transfer_source, "sky", ImageRange::mip(1));
  builder.sink(builder.write(builder.create(BufferDesc{"bytes", 64}), Access::transfer_destination));
  builder.end_pass({});
  plan = compile_graph(builder).plan;
  ASSERT_EQ(plan.final_barriers.images.size(), 1u);
  EXPECT_EQ(plan.final_barriers.images[0].range, (ImageRange{1, 1, 0, 6}));
  EXPECT_TRUE(test::find_hazards(plan).empty());
  plan.final_barriers.images.clear();
  EXPECT_FALSE(test::find_hazards(plan).empty()) << "left in the layout of copies";
}

TEST(GraphRanges, AFrameFillsAnImageForLaterOnesWhichTakeIt) {
  GraphBuilder builder;
  ImageHandle sky;
  const auto fill = [&](std::string name, uint32_t first, uint32_t count) {
    builder.begin_pass(std::move(name));
    if (!sky) sky = builder.create(cube_desc("sky"));
    sky = builder.write(sky, Access::storage_image_write, {0, 1, first, count});
    builder.end_pass({});
  };
  const Hash128 key{1, 2};
  fill("top", 0, 2);
  expect_refused([&] { builder.keep(sky, key, "why"); }, {"sky", "before all of it"});
  fill("rest", 2, 4);
  builder.keep(sky, key, "kept from before");
  EXPECT_TRUE(compile_graph(builder, {.filled = {}, .seen = {key}}).plan.passes.empty()) << "nothing reads it";
  builder.begin_pass("read");
  builder.read(sky, Access::sampled_compute, "sky", ImageRange::layer(5));
  builder.sink(builder.write(builder.create(BufferDesc{"out", 64}), Access::compute_write));
  builder.end_pass({});
  builder.begin_pass("late");
  expect_refused([&] { builder.write(sky, Access::storage_image_write); }, {"sky", "that is kept"});
  builder.end_pass({});
  expect_refused([&] { builder.keep(sky, key, "why"); }, {"sky", "after it was read"});

  const FramePlan alone = compile_graph(builder, {.filled = {{3, 4}}, .seen = {{5, 6}}}).plan;
  EXPECT_EQ(alone.passes.size(), 2u) << "one layer is read, and that one is made";
  EXPECT_FALSE(alone.resources[0].imported);
  EXPECT_EQ(plan_hash(alone), plan_hash(compile_graph(builder).plan));

  const CompiledGraph graph = compile_graph(builder, {.filled = {}, .seen = {key}});
  const FramePlan& plan = graph.plan;
  ASSERT_EQ(plan.passes.size(), 3u) << "one layer is read, and all are made";
  EXPECT_TRUE(test::find_hazards(plan).empty());
  EXPECT_TRUE(plan.resources[0].imported && plan.resources[0].to_fill);
  EXPECT_TRUE(plan.resources[0].keyed);
  EXPECT_EQ(graph.keys, (std::vector<std::pair<int, Hash128>>{{0, key}}));
  EXPECT_EQ(plan.resources[0].block, -1);
  ASSERT_FALSE(plan.final_barriers.images.empty());
  for (const ImageBarrier& barrier : plan.final_barriers.images)
    EXPECT_EQ(barrier.new_layout, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  FramePlan broken = plan;
  broken.final_barriers.images.clear();
  EXPECT_FALSE(test::find_hazards(broken).empty());
  broken = plan;
  for (ImageBarrier& barrier : broken.final_barriers.images) barrier.source_stages = VK_PIPELINE_STAGE_2_HOST_BIT;
  EXPECT_FALSE(test::find_hazards(broken).empty());
  // The plan of a frame that fills it is not that of one that finds it.
  broken = plan;
  broken.resources[0].to_fill = false;
  EXPECT_NE(plan_hash(broken), plan_hash(plan));

  const FramePlan found = compile_graph(builder, {.filled = {key}, .seen = {}}).plan;
  ASSERT_EQ(found.passes.size(), 1u);
  EXPECT_EQ(found.passes[0].name, "read");
  EXPECT_TRUE(test::find_hazards(found).empty());
  EXPECT_TRUE(found.resources[0].imported && !found.resources[0].to_fill);
  const auto reason = [&](std::string_view pass) {
    const auto left = std::ranges::find(found.left_out, pass, &LeftOut::pass);
    return left == found.left_out.end() ? std::string() : left->reason;
  };
  EXPECT_EQ(reason("rest"), "kept from before");
  EXPECT_EQ(reason("top"), "nothing reads sky") << "with or without what is kept";
}

TEST(GraphRanges, APassThatMakesMoreThanAKeptImageIsADefect) {
  GraphBuilder builder;
  builder.begin_pass("both");
  const ImageHandle sky = builder.write(builder.create(cube_desc("sky")), Access::storage_image_write, {0, 1, 0, 6});
  builder.sink(builder.write(builder.create(BufferDesc{"more", 64}), Access::compute_write));
  builder.end_pass({});
  builder.keep(sky, {1, 2}, "kept");
  EXPECT_EQ(compile_graph(builder).plan.passes.size(), 1u);
  try {
    compile_graph(builder, {.filled = {{1, 2}}, .seen = {}});
    FAIL() << "it would write an image that other frames read";
  } catch (const GraphError& e) {
    EXPECT_NE(std::string(e.what()).find("'both' makes more than 'sky'"), std::string::npos) << e.what();
  }
}

TEST(GraphRanges, PlansPrintAndHashParts) {
  const FramePlan plan = chain_plan(3);
  const std::string text = plan_text(plan);
  for (const char* part : {"halve [2 steps]", "chain[mip 0] (sampled_compute) in step 0",
                           "chain[mip 2] (storage_image_write) in step 1", "16x8, 3 mips", "chain (sampled_fragment)"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  EXPECT_EQ(plan.resources[0].bytes, uint64_t(16 * 8 + 8 * 4 + 4 * 2) * 8);
  const nlohmann::json json = nlohmann::json::parse(plan_json(plan));
  EXPECT_EQ(json["passes"][1]["steps"], 2);
  EXPECT_EQ(json["passes"][1]["uses"][1]["mips"], (nlohmann::json{1, 1}));
  EXPECT_EQ(json["passes"][1]["uses"][1]["step"], 0);
  EXPECT_EQ(json["resources"][0]["mips"], 3);
  EXPECT_NE(plan_dot(plan).find("pass0 -> pass1"), std::string::npos);
  EXPECT_NE(plan_dot(plan).find("pass1 -> pass2"), std::string::npos);
  EXPECT_EQ(plan_dot(plan).find("pass1 -> pass1"), std::string::npos);
  EXPECT_NE(plan_hash(chain_plan(3)), plan_hash(chain_plan(4)));
  EXPECT_EQ(plan_hash(chain_plan(3)), plan_hash(chain_plan(3)));
  EXPECT_NE(plan_hash(chain_plan(2, "chain", false)), plan_hash(chain_plan(3, "chain", false)))
      << "an image with a mip more that nobody uses";
}

TEST(GraphRanges, ThousandsOfRandomGraphsHaveNoHazard) {
  size_t steps = 0, parts = 0;
  for (uint32_t seed = 10000; seed < 12500; ++seed) {
    const FramePlan plan = test::RandomGraph(seed).compiled().plan;
    const std::vector<std::string> hazards = test::find_hazards(plan);
    ASSERT_TRUE(hazards.empty()) << "seed " << seed << ": " << hazards[0] << "\n" << plan_text(plan);
    for (const PlanPass& pass : plan.passes) {
      steps += pass.steps() > 1;
      for (const PlanUse& use : pass.uses)
        if (const auto* image = std::get_if<ImageDesc>(&plan.resources[size_t(use.resource)].desc))
          parts += use.range != whole(*image);
    }
  }
  EXPECT_GT(steps, 1000u);
  EXPECT_GT(parts, 5000u);
}

}  // namespace
}  // namespace candela::graph_ranges
