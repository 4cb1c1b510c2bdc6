#include <deque>
#include <set>

#include "frame_fixture.h"

namespace candela::test {

// Shadow maps that frames keep for later ones: the same bytes, less work.
class KeptMaps : public FrameTest {
 protected:
  static std::unique_ptr<Session> open_keeping(const Job& job, uint64_t bytes = uint64_t(512) << 20) {
    RunSettings settings;
    settings.validate = true;
    settings.kept_bytes = bytes;
    auto session = Session::open(job, {}, settings);
    EXPECT_TRUE(session) << session.error().text();
    return session ? std::move(*session) : nullptr;
  }
  static Job small_job(const std::string& name) {
    Job job = job_for(scene(name), 48, 32);
    job.settings = {{"sun", "size_px", "512"}, {"sun", "cascades", "2"}};
    return job;
  }
  static bool draws_maps(const FrameResult& result) {
    return std::ranges::any_of(result.plan.passes, [](const PlanPass& p) { return p.name == "depth_views.sun"; });
  }
  static int left_out_as_kept(const FrameResult& result) {
    return int(std::ranges::count_if(result.left_out, [](const LeftOut& left) {
      return left.reason == "kept from before: nothing that casts has moved" && left.pass.ends_with(".sun");
    }));
  }
};

TEST_F(KeptMaps, AreDrawnNoMoreOnceTheyAreKnown) {
  const Job job = small_job("spheres");
  const auto plain = open(job), keeping = open_keeping(job);
  ASSERT_TRUE(plain && keeping);
  for (int frame = 0; frame < 5; ++frame) {
    const FrameResult without = render(*plain, frame), with = render(*keeping, frame, frame == 4);
    EXPECT_EQ(images(with), images(without)) << frame;
    EXPECT_EQ(with.plan_hash, without.plan_hash) << "the same picture";
    EXPECT_TRUE(draws_maps(without));
    EXPECT_EQ(draws_maps(with), frame < 2) << frame << ": the second fills them, for they came again";
    EXPECT_EQ(left_out_as_kept(with), frame < 2 ? 0 : 3);
    if (frame == 4)
      for (const gpu::PassHash& hash : with.hashes) EXPECT_NE(hash.pass, "depth_views.sun");
  }
}

// Whatever was begun before or in between.
TEST_F(KeptMaps, GiveTheSameBytesInAnyOrderAndInFlight) {
  Job job = small_job("spheres");
  const std::vector<CameraRequest> cameras = [&] {
    std::vector<CameraRequest> list(3, job.camera);
    for (int i = 0; i < 3; ++i) {
      list[size_t(i)].eye = glm::dvec3(3 + i, 2, 4);
      list[size_t(i)].target = glm::dvec3(0);
    }
    return list;
  }();
  std::vector<Images> alone;
  for (const CameraRequest& camera : cameras) {
    job.camera = camera;
    alone.push_back(images_of(job));
  }
  ASSERT_NE(alone[0], alone[1]);
  for (const uint64_t bytes : {uint64_t(512) << 20, uint64_t(3) << 20}) {  // of the second, one set fits
    const auto session = open_keeping(job, bytes);
    ASSERT_TRUE(session);
    int kept = 0;
    std::deque<std::pair<size_t, FrameTicket>> begun;
    const auto finish = [&] {
      const auto result = session->finish(begun.front().second);
      ASSERT_TRUE(result) << result.error().text();
      EXPECT_EQ(images(*result), alone[begun.front().first]);
      kept += !draws_maps(*result);
      begun.pop_front();
    };
    for (const size_t camera : {0, 0, 0, 1, 0, 1, 1, 2, 2, 2, 0, 1, 2, 0}) {
      session->set_camera(cameras[camera]);
      const auto ticket = session->begin(0);
      ASSERT_TRUE(ticket) << ticket.error().text();
      begun.emplace_back(camera, *ticket);
      if (begun.size() == 3) finish();
    }
    while (!begun.empty()) finish();
    EXPECT_EQ(kept, bytes > (uint64_t(16) << 20) ? 8 : 4);
  }
}

// A square that moves over a larger one, to and fro, while the views of the maps stay: the larger one is their bounds.
TEST_F(KeptMaps, FollowTheirCasters) {
  GltfBuilder b = empty_scene();
  add_light(b, {{"type", "directional"}, {"intensity", 3}}, {{"rotation", {0.2588, 0, 0, 0.9659}}});
  const int material = add_material(b, diffuse_material(0.6, 0.6, 0.6));
  add_node(b, {{"mesh", add_square_mesh(b, 4, material)}});
  const int caster = add_node(b, {{"mesh", add_square_mesh(b, 0.6f, material)}, {"translation", {0, 0, 1}}});
  const int times = b.accessor<float>("SCALAR", {0, 1, 2});
  const int places = b.accessor<float>("VEC3", {-1, 0, 1, 1, 0, 1, -1, 0, 1});
  b.json["animations"] = {{{"samplers", {{{"input", times}, {"output", places}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", caster}, {"path", "translation"}}}}}}}};
  Job job = job_for(write(b), 48, 32);
  job.settings = {{"sun", "size_px", "512"}, {"sun", "cascades", "2"}};
  look(job, {0, 0, 9}, {0, 0, 0});
  const auto plain = open(job), keeping = open_keeping(job);
  ASSERT_TRUE(plain && keeping);
  std::set<std::vector<std::byte>> pictures;
  int kept = 0;
  for (const double time : {0.0, 0.5, 1.0, 0.5, 0.0, 1.0, 0.5, 1.0, 0.0}) {
    const FrameResult without = render(*plain, time), with = render(*keeping, time);
    EXPECT_EQ(images(with), images(without)) << time;
    pictures.insert(images(without)["beauty"].bytes);
    kept += !draws_maps(with);
  }
  EXPECT_EQ(pictures.size(), 3u);
  EXPECT_EQ(kept, 3) << "the third of each place";
}

// Of lamps, one of which moves: the maps follow it, and are drawn no more while it stands.
TEST_F(KeptMaps, FollowTheirLamps) {
  GltfBuilder b = empty_scene();
  const int material = add_material(b, diffuse_material(0.6, 0.6, 0.6));
  add_node(b, {{"mesh", add_square_mesh(b, 4, material)}});
  add_node(b, {{"mesh", add_square_mesh(b, 0.6f, material)}, {"translation", {0, 0, 1}}});
  add_light(b, {{"type", "point"}, {"intensity", 30}, {"range", 8}}, {{"translation", {1, 0.5, 2.5}}});
  add_light(b, {{"type", "spot"}, {"intensity", 30}, {"spot", Json::object()}}, {{"translation", {0, 1, 3}}});
  const int times = b.accessor<float>("SCALAR", {0, 1, 2});
  const int places = b.accessor<float>("VEC3", {-1, 0, 2, 1, 0, 3, -1, 0, 2});
  b.json["animations"] = {{{"samplers", {{{"input", times}, {"output", places}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "translation"}}}}}}}};
  Job job = job_for(write(b), 48, 32);
  look(job, {0, 0, 9}, {0, 0, 0});
  const auto plain = open(job), keeping = open_keeping(job);
  ASSERT_TRUE(plain && keeping);
  std::set<std::vector<std::byte>> pictures;
  int drawn = 0;
  for (const double time : {0.0, 0.5, 1.0, 0.5, 0.0, 1.0, 0.5, 1.0, 0.0}) {
    const FrameResult without = render(*plain, time), with = render(*keeping, time);
    EXPECT_EQ(images(with), images(without)) << time;
    EXPECT_EQ(with.plan_hash, without.plan_hash);
    pictures.insert(images(without)["beauty"].bytes);
    drawn += std::ranges::any_of(with.plan.passes, [](const PlanPass& p) { return p.name == "depth_views.local"; });
  }
  EXPECT_EQ(pictures.size(), 3u);
  EXPECT_EQ(drawn, 6) << "not the third time at each place";
}

TEST_F(KeptMaps, OfWhatMovesAreDrawnAnew) {
  for (const char* name : {"animated", "skinned", "morph"}) {
    const Job job = small_job(name);
    const auto plain = open(job), keeping = open_keeping(job);
    ASSERT_TRUE(plain && keeping);
    for (const double time : {0.0, 0.25, 0.5, 0.25, 0.5, 0.5, 0.25}) {
      const FrameResult without = render(*plain, time), with = render(*keeping, time);
      EXPECT_EQ(images(with), images(without)) << name << " " << time;
      if (time == 0) EXPECT_EQ(draws_maps(with), draws_maps(without));
    }
  }
}

}  // namespace candela::test
