#include "plan/frame_dumps.h"

#include <gtest/gtest.h>

#include "gltf/gltf.h"
#include "plan/plan_frame.h"
#include "testscenes/make_scene.h"

namespace candela {
namespace {

TEST(Dumps, AreReadFromTheirText) {
  const auto plain = parse_dump("depth_views.sun.sun.maps"), part = parse_dump("a.b[3,12]");
  ASSERT_TRUE(plain && part);
  EXPECT_EQ(plain->name, "depth_views.sun.sun.maps");
  EXPECT_EQ(plain->text(), plain->name);
  EXPECT_EQ(part->name, "a.b");
  EXPECT_EQ(part->mip, 3u);
  EXPECT_EQ(part->layer, 12u);
  EXPECT_EQ(part->text(), "a.b[3,12]");
  for (const char* wrong : {"", "a", ".b", "a.", "a.b[", "a.b[1]", "a.b[1,2", "a.b[-1,0]", "a.b[1,x]", "a.b[1,2]c"})
    EXPECT_FALSE(parse_dump(wrong)) << wrong;
}

class DumpPlan : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto bytes = make_scene_bytes("spheres", 1, 0);
    ASSERT_TRUE(bytes);
    auto loaded = load_gltf_from_memory(*bytes, "spheres.glb", "");
    ASSERT_TRUE(loaded);
    scene = std::move(*loaded);
    job.width_px = 64;
    job.height_px = 36;
    job.samples = 4;
  }
  Expected<PlannedFrame> plan(std::vector<std::string> dumps) {
    WantedOutputs wanted;
    for (const std::string& text : dumps) wanted.dumps.push_back(*parse_dump(text));
    return plan_frame(job, scene, wanted, 0);
  }
  void expect_refused(const std::string& dump, std::vector<std::string> words) {
    const auto refused = plan({dump});
    ASSERT_FALSE(refused) << dump;
    EXPECT_EQ(refused.error().kind, ErrorKind::usage);
    for (const std::string& word : words)
      EXPECT_NE(refused.error().text().find(word), std::string::npos) << word << " in " << refused.error().text();
  }
  Scene scene;
  Job job;
};

TEST_F(DumpPlan, StandBehindTheirPassAndKeepThePlansHash) {
  const auto without = plan({}), with = plan({"depth_prepass.depth", "shade_forward.depth", "resolve.resolved"});
  ASSERT_TRUE(without && with);
  EXPECT_EQ(without->made->hash, plan_hash(without->graph().plan));
  EXPECT_EQ(with->made->hash, without->made->hash);
  ASSERT_EQ(with->made->dumps.size(), 3u);
  const FramePlan& plan = with->graph().plan;
  const auto place = [&](std::string_view name) {
    for (size_t i = 0; i < plan.passes.size(); ++i)
      if (plan.passes[i].name == name) return int(i);
    return -1;
  };
  EXPECT_EQ(place("dump.0"), place("depth_prepass") + 1);
  EXPECT_EQ(place("dump.1"), place("shade_forward") + 1);
  EXPECT_EQ(place("dump.2"), place("resolve") + 1);
  EXPECT_EQ(plan.passes.size(), without->graph().plan.passes.size() + 3);
  EXPECT_EQ(plan.left_out.size() + 1, without->graph().plan.left_out.size());  // dump
  EXPECT_EQ(plan.resources[size_t(with->made->dumps[0].resource)].name(), "dump.depth");
  EXPECT_EQ(with->made->outputs.size(), without->made->outputs.size());
}

// What the background covers is unwritten behind the surfaces' pass.
TEST_F(DumpPlan, WhatIsSeenEarlyIsCleared) {
  const auto covered = [](const PlannedFrame& frame) {
    for (const PlanResource& resource : frame.graph().plan.resources)
      if (resource.is_image() && resource.name() == "color") return std::get<ImageDesc>(resource.desc).covered;
    ADD_FAILURE();
    return false;
  };
  const auto without = plan({}), with = plan({"shade_forward.color"});
  ASSERT_TRUE(without && with);
  EXPECT_TRUE(covered(*without));
  EXPECT_FALSE(covered(*with));
}

TEST_F(DumpPlan, RefusalsNameWhatIsNear) {
  expect_refused("resolve.resolvd", {"resolve.resolved", "candela plan lists"});
  expect_refused("resolv.resolved", {"resolve.resolved"});
  expect_refused("depth_prepass.color", {"nothing has written color", "depth_prepass"});
  expect_refused("transparent.color", {"transparent", "does not run", "blended"});
  expect_refused("resolve.resolved[1,0]", {"1 mip"});
  expect_refused("resolve.resolved[0,1]", {"1 layer"});
}

// An image that nothing reads is not made, and a dump does not make it.
TEST(DumpsOfGraphs, PrunedImagesSaySo) {
  GraphBuilder builder;
  const auto add = [&](const std::string& pass, ImageHandle image, bool sink) {
    builder.begin_pass(pass);
    if (!image) image = builder.create(ImageDesc{"picture", VK_FORMAT_R8_UNORM, 4, 4});
    image = builder.write(image, Access::storage_image_write);
    if (sink) builder.sink(builder.write(builder.create(BufferDesc{"out", 4}), Access::compute_write));
    builder.end_pass({});
    return image;
  };
  add("kept", add("unread", {}, false), true);
  builder.begin_pass("lost");
  builder.write(builder.create(ImageDesc{"nothing", VK_FORMAT_R8_UNORM, 4, 4}), Access::storage_image_write);
  builder.end_pass({});
  const FramePlan plan = compile_graph(builder).plan;
  EXPECT_TRUE(place_dumps({*parse_dump("kept.picture")}, builder, plan));
  const auto lost = place_dumps({*parse_dump("lost.nothing")}, builder, plan);
  ASSERT_FALSE(lost);
  EXPECT_NE(lost.error().text().find("nothing reads"), std::string::npos) << lost.error().text();
}

}  // namespace
}  // namespace candela
