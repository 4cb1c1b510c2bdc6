#include "base/rng.h"
#include "frame_fixture.h"
#include "passes/lights/pose_lights.h"
#include "passes_fixture.h"
#include "plan/frame_upload.h"
#include "session/device_samples.h"

// Light instances that a compute pass poses, against the host's pose in double.
namespace candela::test {

// Instances of lamps in two nodes, one below a moving and turning parent, among lights of their own nodes.
struct Lamps : GltfBuilder {
  explicit Lamps(glm::dvec3 away, uint32_t count) {
    json["nodes"] = Json::array(), json["scenes"][0]["nodes"] = Json::array();
    const int clay = add_material(*this, {{"pbrMetallicRoughness", base_color(0.7, 0.6, 0.5)}, {"doubleSided", true}});
    const int square = add_square_mesh(*this, 8, clay);
    const double s = std::sqrt(0.5);
    add_node(*this, {{"mesh", square}, {"translation", at(away, {0, -1, -4})}, {"rotation", {-s, 0, 0, s}}});
    add_node(*this, {{"mesh", square}, {"translation", at(away, {0, 0, -7})}});
    add_light(*this, {{"type", "point"}, {"range", 3}}, {{"translation", at(away, {1, 0, -3})}});
    const Json spot = {{"type", "spot"},
                       {"color", {1, 0.8, 0.6}},
                       {"range", 4},
                       {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.7}}}};
    json["extensions"]["KHR_lights_punctual"]["lights"].push_back(spot);
    json["extensions"]["KHR_lights_punctual"]["lights"].push_back({{"type", "point"}, {"intensity", 2}, {"range", 2}});
    const int mover = add_node(*this, {{"translation", at(away, {0, 0.5, -4})}, {"scale", {1, 1.25, 0.75}}});
    json["scenes"][0]["nodes"].erase(json["scenes"][0]["nodes"].size() - 1);
    json["scenes"][0]["nodes"].push_back(mover);
    Rng rng(11);
    json["nodes"].push_back(instances(1, {-2, -0.4, -2}, {2, 1, 2}, count, rng, true));
    json["nodes"][size_t(mover)]["children"] = {int(json["nodes"].size()) - 1};
    Json still = instances(2, {-3, -0.9, -2}, {3, 0.5, 2}, count, rng, false);
    still["translation"] = at(away, {0, 0, -4});
    add_node(*this, still);
    add_light(*this, {{"type", "directional"}, {"intensity", 0.1}}, {{"rotation", {-s, 0, 0, s}}});
    const int times = accessor<float>("SCALAR", {0, 1, 2});
    std::vector<float> places;
    for (const glm::dvec3 p : {glm::dvec3(0, 0.5, -4), glm::dvec3(1, 0.5, -5), glm::dvec3(-1, 0.3, -4)})
      for (int axis = 0; axis < 3; ++axis) places.push_back(float(away[axis] + p[axis]));
    const float turns[] = {0, 0, 0, 1, 0, 0.7071068f, 0, 0.7071068f, 0.5f, 0.5f, 0.5f, 0.5f};
    json["animations"] = {
        {{"samplers",
          {{{"input", times}, {"output", accessor<float>("VEC3", places)}},
           {{"input", times}, {"output", accessor<float>("VEC4", {std::begin(turns), std::end(turns)})}}}},
         {"channels",
          {{{"sampler", 0}, {"target", {{"node", mover}, {"path", "translation"}}}},
           {{"sampler", 1}, {"target", {{"node", mover}, {"path", "rotation"}}}}}}}};
    json["extensionsUsed"] = {"KHR_lights_punctual", "CANDELA_light_instances"};
    json["extensionsRequired"] = {"CANDELA_light_instances"};
  }

  static Json at(glm::dvec3 away, glm::dvec3 p) { return {away.x + p.x, away.y + p.y, away.z + p.z}; }
  Json instances(int light, glm::dvec3 low, glm::dvec3 high, uint32_t count, Rng& rng, bool all) {
    std::vector<float> translation, direction, color, intensity, range, modulation;
    for (uint32_t i = 0; i < count; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        translation.push_back(float(rng.uniform(low[axis], high[axis])));
        direction.push_back(float(rng.uniform(-1, 1) - (axis == 1 ? 1 : 0)));
        color.push_back(float(rng.uniform(0.1, 1)));
      }
      intensity.push_back(float(rng.uniform(0.2, 2)));
      range.push_back(float(std::exp(rng.uniform(-1.5, 1))));
      modulation.insert(modulation.end(),
                        {float(rng.uniform(0, 0.9)), float(rng.uniform(0.3, 3)), float(rng.uniform())});
    }
    Json attributes = {{"TRANSLATION", accessor<float>("VEC3", translation)}};
    attributes["MODULATION"] = accessor<float>("VEC3", modulation);
    if (all) {
      attributes["DIRECTION"] = accessor<float>("VEC3", direction);
      attributes["COLOR"] = accessor<float>("VEC3", color);
      attributes["INTENSITY"] = accessor<float>("SCALAR", intensity);
      attributes["RANGE"] = accessor<float>("SCALAR", range);
    }
    return {{"extensions", {{"CANDELA_light_instances", {{"light", light}, {"attributes", attributes}}}}}};
  }
};

namespace {

class PosedLights : public FrameTest {
 protected:
  static Job job_of(const GltfBuilder& scene, glm::dvec3 away, const std::string& technique, bool on_device) {
    Job job = job_for(write(scene), 101, 67);
    job.technique = technique;
    job.effects = "none";
    job.settings = {{"lights", "few", "0"}, {"pose_lights", "enabled", on_device ? "on" : "off"}};
    look(job, away + glm::dvec3(0, 0.5, 3), away + glm::dvec3(0, 0, -4), 60);
    return job;
  }
  static bool in_plan(const FrameResult& frame, std::string_view pass) {
    return std::ranges::any_of(frame.plan->passes, [&](const PlanPass& p) { return p.name == pass; });
  }
};

// Whatever the technique and the kind of list: the host's pose and grid, and every light at every pixel, give the same.
TEST_F(PosedLights, GiveTheBytesOfTheHostsPose) {
  const glm::dvec3 away(2e6, -1000, 3e6);
  for (const uint32_t count : {24u, 150u}) {
    const Lamps scene(away, count);
    const auto expected = open(job_of(scene, away, "brute-force", false));
    ASSERT_TRUE(expected);
    for (const double time_s : count == 24u ? std::vector{0.0, 1.3} : std::vector{1.3}) {
      const Images truth = images(render(*expected, time_s));
      size_t lit = 0;
      for (const glm::vec4& p : truth["beauty"].values<glm::vec4>()) lit += p.x + p.y + p.z > 0;
      EXPECT_GT(lit, 3000u);
      for (const char* technique : {"brute-force", "clustered", "forward-plus"}) {
        Job job = job_of(scene, away, technique, true);
        const bool lists = technique != std::string_view("brute-force");
        if (lists) job.layers = {"heatmap_lights", "heatmap_missed"};
        const auto session = open(job);
        ASSERT_TRUE(session);
        const FrameResult frame = render(*session, time_s);
        EXPECT_TRUE(in_plan(frame, "pose_lights"));
        EXPECT_EQ(in_plan(frame, "light_bounds"), lists);
        const Images got = images(frame);
        EXPECT_TRUE(truth["beauty"] == got["beauty"]) << technique << " " << count << " at " << time_s;
        if (!lists) continue;
        double listed = 0;
        for (const float n : got["heatmap_lights"].values<float>()) listed += double(n);
        for (const float n : got["heatmap_missed"].values<float>()) ASSERT_EQ(n, 0.0f);
        EXPECT_GT(listed, 0);
        EXPECT_LT(listed, 0.8 * double(got["beauty"].pixels()) * (2.0 * count + 2)) << "lists must leave lights out";
      }
    }
  }
}

// Nothing is gained where the device is a CPU, whose lists need the host's pose to be filled in light order.
TEST_F(PosedLights, StayWithTheHostOfACpuOrWhereTheyAreFew) {
  constexpr uint32_t few = PoseLights::Knobs::few;
  const auto on_device = [](int enabled, bool is_cpu, uint32_t instances) {
    return PoseLights::Knobs{enabled}.on_device(is_cpu, instances);
  };
  EXPECT_TRUE(on_device(PoseLights::Knobs::automatic, false, few));
  EXPECT_FALSE(on_device(PoseLights::Knobs::automatic, false, few - 1));
  EXPECT_FALSE(on_device(PoseLights::Knobs::automatic, true, few));
  EXPECT_TRUE(on_device(PoseLights::Knobs::on, true, 1));
  EXPECT_FALSE(on_device(PoseLights::Knobs::off, false, few));
  const Lamps scene(glm::dvec3(0), few / 2);
  Job job = job_of(scene, glm::dvec3(0), "clustered", true);
  job.settings.pop_back();
  const auto session = open(job);
  ASSERT_TRUE(session);
  const bool is_cpu = shades_on_cpu(session->device());
  const FrameResult frame = render(*session);
  EXPECT_NE(in_plan(frame, "pose_lights"), is_cpu);
  EXPECT_NE(in_plan(frame, "light_sort"), is_cpu);
}

// What the host has to look at itself: lamps for shadow maps.
TEST_F(PosedLights, StayWithTheHostWhereItChoosesLamps) {
  const Lamps scene(glm::dvec3(0), 24);
  Job job = job_of(scene, glm::dvec3(0), "clustered", true);
  job.effects = "auto";
  const auto session = open(job);
  ASSERT_TRUE(session);
  const FrameResult frame = render(*session);
  EXPECT_FALSE(in_plan(frame, "pose_lights"));
  EXPECT_TRUE(in_plan(frame, "light_assign"));
}

}  // namespace
}  // namespace candela::test

namespace candela::gpu::test {
namespace {

class PoseLightsPass : public PassTest {};

// Each float of each light is the host's, which has it in double and rounds it once.
TEST_F(PoseLightsPass, RoundsToTheHostsFloats) {
  const glm::dvec3 away(2e6, -1000, 3e6);
  const auto scene = candela::test::Lamps(away, 400).load();
  ASSERT_TRUE(scene) << scene.error().text();
  const LightLayout layout = layout_lights(*scene);
  ASSERT_EQ(layout.instance_count, 800u);
  const GeometryLayout geometry = *layout_geometry(*scene);
  View view;
  view.position = away + glm::dvec3(0.123, 0.456, 3.21);
  for (const double time_s : {0.0, 0.77, 1.9, 12345.678}) {
    const Pose pose = evaluate_pose(*scene, *choose_animations(*scene, "all"), time_s);
    const auto upload_of = [&](const LightLayout* lights) {
      const FrameData data = make_frame_data(*scene, pose, view, 0.05, {lights});
      return make_frame_upload(*scene, pose, view, data, make_draw_list(*scene, pose, data, false), geometry, {}, {});
    };
    const FrameUpload expected = upload_of(nullptr), given = upload_of(&layout);
    ASSERT_EQ(expected.lights.size(), 802u);
    ASSERT_EQ(given.lights.size(), 2u);
    const Buffer groups = upload(given.light_groups, "groups"), posed = upload(given.lights, "posed"),
                 instances = upload(pack_light_instances(*scene, layout), "instances");
    GraphBuilder builder;
    SceneInputs s;
    s.light_groups = import(builder, groups, "groups");
    s.light_instances = import(builder, instances, "instances");
    s.posed_lights = import(builder, posed, "posed");
    s.light_room = 802, s.light_group_count = uint32_t(given.light_groups.size());
    FrameValues values;
    values.time_s = time_s, values.light_count = 802;
    s.values = &values;
    const BufferHandle lights = add(builder, PoseLights{}, {s}).lights;
    const size_t bytes = 802 * sizeof(shared::Light);
    const BufferHandle words = read_words(builder, "lights", lights, bytes);
    const FrameRun run = run_all(builder);
    std::vector<shared::Light> got(802);
    std::memcpy(got.data(), run.readbacks.at(words.resource)->bytes().data(), bytes);
    size_t differing = 0;
    for (size_t i = 0; i < got.size(); ++i)
      differing += std::memcmp(&got[i], &expected.lights[i], sizeof(shared::Light)) != 0;
    EXPECT_EQ(differing, 0u) << "at " << time_s;
  }
}

}  // namespace
}  // namespace candela::gpu::test
