// Many dim lamps, whose light beyond their ends comes from stand-ins (plan/stand_ins.h), against the frame in which
// they have no end.
#include "base/rng.h"
#include "frame_fixture.h"

namespace candela::test {

class FrameStandIns : public FrameTest {
 protected:
  static constexpr int width = 48, height = 36;
  // Over a floor of 10 m with a block on it.
  static Job dim_lamps(int count) {
    GltfBuilder b = empty_scene();
    const int grey = add_material(b, diffuse_material(0.7, 0.6, 0.5));
    add_node(b, {{"mesh", add_square_mesh(b, 5, grey)}});
    const double h = std::sqrt(0.5);
    add_node(b, {{"mesh", add_square_mesh(b, 1, grey)}, {"translation", {0, -1, 1}}, {"rotation", {h, 0, 0, h}}});
    Rng rng(5);
    for (int i = 0; i < count; ++i)
      add_light(b, {{"type", "point"}, {"intensity", 0.05}, {"color", {1, rng.uniform(0.5, 1), rng.uniform(0.3, 1)}}},
                {{"translation", {rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(0.5, 1.5)}}});
    Job job = job_for(write(b), width, height);
    look(job, {0.3, -8, 5}, {0, 0, 0}, 50);
    job.effects = "none";
    job.settings = {{"lights", "lost", "0.05"}};
    return job;
  }
  static std::vector<KnobSetting> endless() { return {{"lights", "lost", "0"}}; }
};

// In every technique, whose pixels are the same: those lists that have stand-ins leave none out.
TEST_F(FrameStandIns, GiveTheLightOfManyDimLamps) {
  Job job = dim_lamps(400);
  std::vector<glm::vec4> truth, first;
  {
    Job whole = job;
    whole.settings = endless();
    truth = images_of(whole)["beauty"].values<glm::vec4>();
  }
  for (const std::string& technique : technique_names()) {
    job.technique = technique;
    const auto session = open(job);
    ASSERT_TRUE(session);
    const FrameResult frame = render(*session);
    EXPECT_TRUE(std::ranges::any_of(frame.notes, [](const std::string& note) { return note.contains("stand-in"); }))
        << technique;
    const auto made = images_of(job)["beauty"].values<glm::vec4>();
    for (size_t i = 0; i < made.size(); ++i)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(made[i][c], truth[i][c], 0.05f * std::max(truth[i][c], 0.01f)) << technique << " " << i;
    if (has_own_pixels(technique)) continue;
    if (first.empty()) first = made;
    EXPECT_EQ(made, first) << technique;
  }
}

// Their light is that of points, without maps; with every other layer, in fog, and traced.
TEST_F(FrameStandIns, GoWithEverythingElse) {
  Job job = dim_lamps(300);
  job.effects = "auto";
  const Images layered = images_of(with_layers(job));
  for (const Image& image : layered)
    if (image.layer == "beauty" || image.layer.starts_with("direct"))
      for (const float v : image.values<float>()) EXPECT_TRUE(std::isfinite(v)) << image.layer;
  double point = 0, direct = 0;
  for (size_t i = 0; i < layered["direct_point"].pixels(); ++i) {
    point += double(layered["direct_point"].values<glm::vec4>()[i].x);
    direct += double(layered["direct"].values<glm::vec4>()[i].x);
  }
  EXPECT_GT(point, 0);
  EXPECT_NEAR(point, direct, 1e-5 * direct);

  Job fog = job;
  fog.look = look_file(R"({"fog": {"extinction": 0.05, "albedo": 0.8}})");
  fog.effects = "fog";
  Job whole = fog;
  whole.settings = endless();
  double made = 0, all = 0;
  const Images foggy = images_of(fog), truth = images_of(whole);
  for (size_t i = 0; i < foggy["beauty"].pixels(); ++i)
    made += double(foggy["beauty"].values<glm::vec4>()[i].x), all += double(truth["beauty"].values<glm::vec4>()[i].x);
  EXPECT_NEAR(made, all, 0.05 * all);

  Job traced = job;
  traced.settings.push_back({"local", "method", "traced"});
  traced.effects = "shadows";
  for (const glm::vec4& p : images_of(traced)["beauty"].values<glm::vec4>())
    EXPECT_TRUE(std::isfinite(p.x) && p.x >= 0);
}

}  // namespace candela::test
