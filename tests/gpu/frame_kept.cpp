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
    return std::ranges::any_of(result.plan->passes, [](const PlanPass& p) { return p.name == "depth_views.sun"; });
  }
  static int left_out_as_kept(const FrameResult& result) {
    return int(std::ranges::count_if(result.plan->left_out, [](const LeftOut& left) {
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

// Of lamps, one of which moves: the maps follow it, and where it was before there is one.
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
    EXPECT_EQ(with.timings.lamp_maps, without.timings.lamp_maps);
    EXPECT_EQ(without.timings.lamp_maps_drawn, without.timings.lamp_maps);
    drawn += with.timings.lamp_maps_drawn > 0;
  }
  EXPECT_EQ(pictures.size(), 3u);
  EXPECT_EQ(drawn, 3) << "the first time at each place";
}

// Lamps over standing and moving things, a masked one among them, seen by a camera that comes near.
class KeptLampMaps : public KeptMaps, public ::testing::WithParamInterface<const char*> {
 protected:
  struct Moment {
    double time_s;
    CameraRequest camera;
  };
  static constexpr int last = 5;
  // moving: nothing, a square that the first two lamps reach, or the point lamps.
  enum class Moving { nothing, caster, lamps };
  static Job lit_job(Moving moving, const std::string& technique) {
    GltfBuilder b = empty_scene();
    const int material = add_material(b, diffuse_material(0.6, 0.6, 0.6));
    Json holes = diffuse_material(0.5, 0.5, 0.5);
    holes["alphaMode"] = "MASK";
    holes["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.7;
    add_node(b, {{"mesh", add_square_mesh(b, 20, material)}});
    const int caster = add_node(b, {{"mesh", add_square_mesh(b, 0.6f, material)}, {"translation", {0, 0, 1}}});
    add_node(b, {{"mesh", add_square_mesh(b, 0.5f, add_material(b, holes))}, {"translation", {4.2, 0.3, 1}}});
    add_node(b, {{"mesh", add_square_mesh(b, 0.7f, material)}, {"translation", {-4, 0, 0.6}}});
    add_node(b, {{"mesh", add_square_mesh(b, 0.3f, material)}, {"translation", {0.8, 0.7, 0.7}}});
    add_light(b, {{"type", "point"}, {"intensity", 30}, {"range", 4}}, {{"translation", {0.3, 0.2, 2}}});
    add_light(b, {{"type", "spot"}, {"intensity", 60}, {"range", 6}, {"spot", Json::object()}},
              {{"translation", {0.5, 1, 3}}});
    add_light(b, {{"type", "point"}, {"intensity", 20}, {"range", 3}}, {{"translation", {4, 0.5, 1.8}}});
    add_light(b, {{"type", "point"}, {"intensity", 20}, {"range", 3}}, {{"translation", {-4, -0.5, 1.7}}});
    const int times = b.accessor<float>("SCALAR", {0, 1});
    const int places = b.accessor<float>("VEC3", {-0.5, 0, 1, moving == Moving::caster ? 0.5f : -0.5f, 0, 1});
    b.json["animations"] = {
        {{"samplers", {{{"input", times}, {"output", places}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", caster}, {"path", "translation"}}}}}}}};
    for (size_t n = 0; moving == Moving::lamps && n < b.json["nodes"].size(); ++n) {
      if (b.json["nodes"][n].value("extensions", Json()).empty()) continue;
      const Json at = b.json["nodes"][n]["translation"];
      const int from_to = b.accessor<float>("VEC3", {at[0], at[1], at[2], float(at[0]) + 0.2f, at[1], at[2]});
      Json& animation = b.json["animations"][0];
      animation["channels"].push_back(
          {{"sampler", animation["samplers"].size()}, {"target", {{"node", n}, {"path", "translation"}}}});
      animation["samplers"].push_back({{"input", times}, {"output", from_to}});
    }
    Job job = job_for(write(b), 48, 32);
    job.technique = technique;
    job.layers = {"shadow_local"};
    return job;
  }
  // From afar to near by, and aside a little, by steps that no float holds.
  static Moment moment(const Job& job, int frame) {
    Moment m{frame / double(last), job.camera};
    m.camera.eye = glm::dvec3(0.1 * frame, -1.3 - 0.31 * frame, 24 - 3.7 * frame);
    m.camera.target = glm::dvec3(0.07 * frame, 0, 0);
    return m;
  }
  static std::vector<Images> alone(Job job) {
    std::vector<Images> all;
    for (int frame = 0; frame <= last; ++frame) {
      const Moment m = moment(job, frame);
      job.camera = m.camera;
      all.push_back(images_of(job, {}, m.time_s));
    }
    return all;
  }
  // Of the frames in that order: how many maps each reads, draws, and draws what moves over.
  struct Counts {
    uint64_t used, drawn, over;
  };
  static std::vector<Counts> film(const Job& job, const std::vector<int>& frames, const std::vector<Images>& expected,
                                  uint64_t bytes = uint64_t(512) << 20) {
    std::vector<Counts> counts;
    const auto session = open_keeping(job, bytes);
    if (!session) return counts;
    for (const int frame : frames) {
      const Moment m = moment(job, frame);
      session->set_camera(m.camera);
      const FrameResult result = render(*session, m.time_s);
      EXPECT_EQ(images(result), expected[size_t(frame)]) << frame;
      counts.push_back({result.timings.lamp_maps, result.timings.lamp_maps_drawn, result.timings.lamp_maps_over});
    }
    return counts;
  }
  static const std::vector<std::vector<int>>& orders() {
    static const std::vector<std::vector<int>> all = {
        {0, 1, 2, 3, 4, 5}, {5, 4, 3, 2, 1, 0}, {0, 2, 4}, {1, 3, 5}, {3, 0, 3, 5, 1, 3}};
    return all;
  }
};

TEST_P(KeptLampMaps, OfStandingThingsAreDrawnOnceForEachSize) {
  const Job job = lit_job(Moving::nothing, GetParam());
  const std::vector<Images> expected = alone(job);
  std::set<std::vector<std::byte>> pictures;
  for (Images of_frame : expected) pictures.insert(of_frame["beauty"].bytes);
  EXPECT_EQ(pictures.size(), size_t(last) + 1);
  for (const std::vector<int>& order : orders()) {
    const auto counts = film(job, order, expected);
    ASSERT_EQ(counts.size(), order.size());
    uint64_t used = 0, drawn = 0;
    for (const Counts& c : counts) used += c.used, drawn += c.drawn;
    EXPECT_EQ(counts[0].drawn, counts[0].used);
    EXPECT_LT(drawn, used) << order[0];
  }
  // Once there is room for all, none is drawn again.
  const auto often = film(job, {0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 4, 5, 5, 3, 1, 0, 2, 4}, expected);
  for (size_t i = 12; i < often.size(); ++i) EXPECT_EQ(often[i].drawn, 0u) << i;
}

TEST_P(KeptLampMaps, FollowWhatMovesAmongStandingThings) {
  const Job job = lit_job(Moving::caster, GetParam());
  const std::vector<Images> expected = alone(job);
  for (const std::vector<int>& order : orders()) film(job, order, expected);
  const auto counts = film(job, {0, 1, 1, 2}, expected);
  ASSERT_EQ(counts.size(), 4u);
  EXPECT_GT(counts[1].over, 0u) << "something moved";
  EXPECT_LT(counts[1].over, counts[1].used) << "two lamps do not reach it";
  EXPECT_EQ(counts[2].drawn + counts[2].over, 0u);
}

// The camera stands: what stands is drawn by the first frame, and then what moves alone.
TEST_P(KeptLampMaps, OfStandingThingsStayUnderWhatMoves) {
  Job job = lit_job(Moving::caster, GetParam());
  job.camera = moment(job, 3).camera;
  std::set<std::vector<std::byte>> pictures;
  const auto session = open_keeping(job);
  ASSERT_TRUE(session);
  for (const double time : {0.0, 0.3, 0.6, 1.0, 0.6}) {
    Images expected = images_of(job, {}, time);
    pictures.insert(expected["beauty"].bytes);
    const FrameResult result = render(*session, time);
    EXPECT_EQ(images(result), expected) << time;
    EXPECT_EQ(result.plan_hash, render(*open(job), time).plan_hash);
    const Timings& t = result.timings;
    EXPECT_EQ(t.lamp_maps_drawn, time == 0 ? t.lamp_maps : 0) << time;
    EXPECT_LT(t.lamp_maps_over, t.lamp_maps);
    if (pictures.size() == 4 && time == 0.6)
      EXPECT_EQ(t.lamp_maps_over, 0u) << "it was there";
    else
      EXPECT_GT(t.lamp_maps_over, 0u) << time;
  }
  EXPECT_EQ(pictures.size(), 4u);
}

// Lamps that move have nothing that stands.
TEST_P(KeptLampMaps, OfMovingLampsAreDrawnAsOne) {
  const Job job = lit_job(Moving::lamps, GetParam());
  for (const Counts& c : film(job, {0, 1, 2, 3}, alone(job))) {
    EXPECT_EQ(c.drawn, c.used);
    EXPECT_EQ(c.over, 0u);
  }
}

// Memory for a part of the maps that a film needs, and for less than those of one frame.
TEST_P(KeptLampMaps, AreDrawnAgainWhereTheirMemoryIsTooSmall) {
  Job job = lit_job(Moving::lamps, GetParam());
  job.settings = {{"local", "budget_mb", "2"}};
  job.width_px = 384, job.height_px = 256;
  const std::vector<Images> expected = alone(job);
  const std::vector<int> to_and_fro = {0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 4, 5};
  uint64_t again = 0;
  const auto counts = film(job, to_and_fro, expected);
  for (size_t i = 6; i < counts.size(); ++i) again += counts[i].drawn;
  EXPECT_GT(again, 0u) << "it holds not all";
  for (const Counts& c : film(job, to_and_fro, expected, uint64_t(3) << 20)) EXPECT_EQ(c.used, c.drawn);
}

// What stands and what moves over it do not fit together: each map is one again.
TEST_P(KeptLampMaps, AreWholeWhereTheirPartsDoNotFit) {
  Job job = lit_job(Moving::caster, GetParam());
  job.settings = {{"local", "budget_mb", "4"}};
  job.width_px = 720, job.height_px = 480;
  const std::vector<Images> expected = alone(job);
  for (const uint64_t megabytes : {4, 8}) {
    uint64_t over = 0, drawn = 0, used = 0;
    for (const Counts& c : film(job, {4, 5, 4}, expected, megabytes << 20))
      over += c.over, drawn += c.drawn, used += c.used;
    EXPECT_EQ(over > 0, megabytes > 4) << megabytes;
    EXPECT_LT(drawn, used) << megabytes;
  }
}

INSTANTIATE_TEST_SUITE_P(Techniques, KeptLampMaps, ::testing::Values("clustered", "visibility"),
                         [](const auto& info) { return std::string(info.param); });

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
