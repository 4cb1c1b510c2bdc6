#include "frame_fixture.h"
#include "instances_fixture.h"

// Instances of meshes that a compute pass poses give the bytes that they give where the host poses them.
namespace candela::test {
namespace {

class PosedItems : public FrameTest {
 protected:
  static Job job_of(const std::string& scene, glm::dvec3 away, const std::string& technique, bool on_device) {
    Job job = job_for(scene, 96, 64);
    job.technique = technique;
    job.effects = "none";
    job.layers = {"depth", "normal", "object_id", "material_id"};
    job.settings = {{"pose_items", "enabled", on_device ? "1" : "0"}};
    look(job, away + glm::dvec3(0, 0.5, 2), away + glm::dvec3(0, 0, -4), 60);
    return job;
  }
  static bool poses(const FrameResult& frame) {
    return std::ranges::any_of(frame.plan->passes, [](const PlanPass& p) { return p.name == "pose_items"; });
  }
};

// Items of the host before, between and behind those of groups, in the hardware's order and in that of batches.
TEST_F(PosedItems, GiveTheBytesOfTheHostsPose) {
  const glm::dvec3 away(2e6, -1000, 3e6);
  const std::string scene = write(Crowd(away, 70));
  for (const char* technique : {"clustered", "deferred-clustered", "visibility"}) {
    const auto host = open(job_of(scene, away, technique, false)), device = open(job_of(scene, away, technique, true));
    ASSERT_TRUE(host && device);
    for (const double time_s : {0.0, 1.3}) {
      const FrameResult expected = render(*host, time_s), got = render(*device, time_s);
      EXPECT_FALSE(poses(expected));
      EXPECT_TRUE(poses(got));
      for (const Image& image : images(expected))
        EXPECT_TRUE(image == images(got)[image.layer]) << technique << " " << image.layer << " at " << time_s;
    }
  }
}

// What a session made before leaves no trace: a frame alone, in order, out of order and again.
TEST_F(PosedItems, GiveTheSameBytesHoweverTheFrameIsReached) {
  const glm::dvec3 away(0);
  const std::string scene = write(Crowd(away, 40));
  const Job job = job_of(scene, away, "visibility", true);
  const std::vector<double> order = {0.4, 0, 1.9, 0.4, 0.9};
  std::map<double, Images> alone;
  for (const double time_s : order)
    if (!alone.contains(time_s)) alone[time_s] = images_of(job, {}, time_s);
  EXPECT_FALSE(alone[0] == alone[1.9]) << "something moves";
  const auto session = open(job);
  ASSERT_TRUE(session);
  for (const double time_s : order) EXPECT_TRUE(alone[time_s] == images(render(*session, time_s))) << time_s;
}

// Orthographic views ask how far things lie on all sides.
TEST_F(PosedItems, GiveTheBytesOfTheHostsPoseInOrthographicViews) {
  Crowd crowd(glm::dvec3(0), 70);
  crowd.json["cameras"] = {
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0.1}, {"zfar", 50}}}}};
  add_node(crowd, {{"camera", 0}, {"translation", {0, 0, 3}}});
  const std::string scene = write(crowd);
  std::vector<Images> both;
  for (const bool on_device : {false, true}) {
    Job job = job_of(scene, {}, "clustered", on_device);
    job.camera = {};
    job.settings.push_back({"lights", "few", "0"});
    job.layers.push_back("heatmap_lights");
    both.push_back(images_of(job));
  }
  EXPECT_TRUE(both[0] == both[1]);
}

// Shadow maps: views fitted to what is drawn, room for their draws, and least sizes of what is drawn into them.
TEST_F(PosedItems, GiveTheBytesOfTheHostsPoseWithShadowMaps) {
  const glm::dvec3 away(2e5, 0, -3e5);
  const std::string scene = write(Crowd(away, 70));
  for (const char* technique : {"clustered", "visibility"}) {
    std::vector<Images> both;
    for (const bool on_device : {false, true}) {
      Job job = job_of(scene, away, technique, on_device);
      job.effects = "auto";
      job.settings.push_back({"occlusion", "method", "screen"});  // trees need the host's pose
      const auto session = open(job);
      ASSERT_TRUE(session);
      const FrameResult frame = render(*session, 1.3);
      EXPECT_EQ(poses(frame), on_device);
      for (const char* maps : {"cull.sun", "cull.local"})
        EXPECT_TRUE(std::ranges::any_of(frame.plan->passes, [&](const PlanPass& p) { return p.name == maps; })) << maps;
      both.push_back(images(frame));
    }
    EXPECT_TRUE(both[0] == both[1]) << technique;
  }
}

// Maps of what does not move are kept, and drawn anew where something has moved.
TEST_F(PosedItems, KeepShadowMapsOfWhatDoesNotMove) {
  const std::string scene = write(Crowd(glm::dvec3(0), 40));
  Job job = job_of(scene, {}, "clustered", true);
  job.effects = "auto";
  RunSettings settings;
  settings.validate = true;
  settings.kept_bytes = uint64_t(64) << 20;
  auto session = Session::open(job, {}, settings);
  ASSERT_TRUE(session) << session.error().text();
  const auto kept = [](const FrameResult& frame) {
    return std::ranges::any_of(frame.plan->left_out,
                               [](const LeftOut& l) { return l.reason.starts_with("kept from before"); });
  };
  std::map<double, Images> alone;
  for (const double time_s : {2.0, 0.5}) alone[time_s] = images_of(job, {}, time_s);
  // Behind its last key nothing moves any more.
  const std::vector<std::pair<double, bool>> frames = {{2, false}, {2, false}, {2, true}, {0.5, false}, {2, true}};
  for (const auto& [time_s, expected] : frames) {
    const FrameResult frame = render(**session, time_s);
    EXPECT_TRUE(alone[time_s] == images(frame)) << time_s;
    EXPECT_EQ(kept(frame), expected) << time_s;
  }
}

// What looks at each item on the host.
TEST_F(PosedItems, StayWithTheHostWhereTheTimeBeforeIsAsked) {
  const std::string scene = write(Crowd(glm::dvec3(0), 20));
  Job job = job_of(scene, {}, "clustered", true);
  job.layers = {"motion"};
  const auto session = open(job);
  ASSERT_TRUE(session);
  EXPECT_FALSE(poses(render(*session)));
}

}  // namespace
}  // namespace candela::test
