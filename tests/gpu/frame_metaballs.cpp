// Bodies of metaballs in whole frames: every technique, beside instances that the device poses, from frame to frame.
#include "frame_fixture.h"
#include "instances_fixture.h"
#include "testscenes/make_scene.h"

namespace candela::test::frame_metaballs {
namespace {

// A body of two balls of half a metre, `apart` from each other along x; the second drives over a metre in a second.
// Returns its node.
int add_body(GltfBuilder& b, int material, glm::dvec3 at, double apart = 0.5, double cell = 0.1) {
  const int body = add_node(b, {{"translation", {at.x, at.y, at.z}}}), first = body + 1, second = body + 2;
  b.json["nodes"].push_back({{"translation", {-apart / 2, 0, 0}}});
  b.json["nodes"].push_back({{"translation", {apart / 2, 0, 0}}});
  b.json["nodes"][size_t(body)]["children"] = {first, second};
  b.json["nodes"][size_t(body)]["extensions"]["CANDELA_metaballs"] = {
      {"threshold", 0.25},
      {"radius", 0.5},
      {"cell", cell},
      {"material", material},
      {"balls", {{{"node", first}}, {{"node", second}}}}};
  b.use("CANDELA_metaballs", true);
  const float x = float(apart / 2);
  b.json["animations"].push_back(
      {{"samplers",
        {{{"input", b.accessor<float>("SCALAR", {0, 1})}, {"output", b.accessor<float>("VEC3", {x, 0, 0, x, 1, 0})}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", second}, {"path", "translation"}}}}}}});
  return body;
}

GltfBuilder alone(const char* mode = "OPAQUE", bool lets_through = false) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json material = diffuse_material(0.7, 0.6, 0.3);
  material["alphaMode"] = mode;
  if (std::string(mode) == "BLEND") material["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.5;
  if (lets_through) {
    b.use("KHR_materials_transmission");
    material["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 0.7;
  }
  add_node(b, {{"mesh", add_square_mesh(b, 3, add_material(b, diffuse_material(0.3, 0.4, 0.5)))},
               {"translation", {0, 0, -1.5}}});
  add_body(b, add_material(b, material), {0, 0, 0});
  add_light(b, {{"type", "point"}, {"intensity", 20}}, {{"translation", {1, 2, 3}}});
  return b;
}

}  // namespace

class FrameMetaballs : public FrameTest {
 protected:
  static Job job_of(const std::string& file) {
    Job job = job_for(file, 48, 36);
    look(job, {0, 0.3, 2.5}, {0, 0, 0}, 45);
    return job;
  }
  static bool holds(const FrameResult& result, const std::string& what) {
    return std::ranges::any_of(result.plan->resources,
                               [&](const PlanResource& r) { return r.name().find(what) != std::string::npos; });
  }
};

TEST_F(FrameMetaballs, AreDrawnWhereNothingElseIs) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  add_body(b, add_material(b, diffuse_material(0.7, 0.6, 0.3)), {0, 0, 0});
  add_light(b, {{"type", "point"}, {"intensity", 20}}, {{"translation", {1, 2, 3}}});
  Job job = job_of(write(b));
  job.layers = {"depth"};
  const auto depths_of = [&](const char* technique, const char* culls) {
    Job asked = job;
    asked.technique = technique;
    asked.settings.push_back({"occlusion_cull", "mode", culls});
    return images_of(asked, {}, 0.5);
  };
  const Images first = depths_of("clustered", "off");
  size_t seen = 0;
  for (const float depth : first["depth"].values<float>()) seen += depth < 10;
  EXPECT_GT(seen, 150u);
  for (const char* technique : {"clustered", "deferred-tiled", "visibility", "ray"})
    EXPECT_TRUE(depths_of(technique, "on")["depth"] == first["depth"]) << technique;
}

TEST_F(FrameMetaballs, AreTheSameInAllTechniques) {
  Job job = job_of(write(alone()));
  job.layers = {"depth", "normal", "object_id", "motion"};
  std::optional<Images> first;
  for (const char* technique : {"brute-force", "clustered", "deferred-tiled", "visibility", "ray"}) {
    job.technique = technique;
    const Images images = images_of(job, {}, 0.5);
    if (!first) first = images;
    for (const char* layer : {"depth", "normal", "object_id", "motion"})
      EXPECT_TRUE(images[layer] == (*first)[layer]) << technique << " " << layer;
  }
  size_t seen = 0;
  for (const uint32_t id : (*first)["object_id"].values<uint32_t>()) seen += id == 1;
  EXPECT_GT(seen, 150u);
}

// Seen through, sorted and covering: no message of validation, and the body is there.
TEST_F(FrameMetaballs, TakeAnyMaterial) {
  for (const auto& [mode, lets_through] :
       {std::pair("BLEND", false), std::pair("MASK", false), std::pair("OPAQUE", true)}) {
    Job job = job_of(write(alone(mode, lets_through)));
    const Images with = images_of(job, {}, 0.5);
    job.effects = "none";
    for (const float v : with["beauty"].values<float>()) ASSERT_TRUE(std::isfinite(v));
    GltfBuilder bare = alone(mode, lets_through);
    bare.json["nodes"][1]["extensions"]["CANDELA_metaballs"]["threshold"] = 3;
    Job without = job_of(write(bare));
    EXPECT_FALSE(with["beauty"] == images_of(without, {}, 0.5)["beauty"]) << mode << lets_through;
  }
}

// A body of glass that reaches beyond a side of a lamp's cube, where texels of that side hold next to no light: the
// floor in front of it gets no more than comes in.
TEST_F(FrameMetaballs, BendNoMoreLightThanComesIn) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "candela_metaballs_glass.glb";
  ASSERT_TRUE(make_scene("metaballs-glass", 1, 0, file));
  const auto light_of_floor = [&](const char* scale) {
    Job job = job_for(file, 96, 72);
    job.settings = {{"colored_shadows", "scale", scale}, {"sun", "mode", "off"}};
    const Image beauty = images_of(job)["beauty"];
    double sum = 0;
    for (int y = 60; y < 72; ++y)
      for (int x = 0; x < 96; ++x) sum += beauty.at<glm::vec4>(x, y).y;
    return sum;
  };
  const double bent = light_of_floor("half"), plain = light_of_floor("off");
  fmt::print("{:.3f} of the light without bodies that bend it\n", bent / plain);
  EXPECT_NEAR(bent / plain, 1, 0.1);
}

// The first item of a body stands somewhere in the order of drawing, among groups of instances that the device poses.
TEST_F(FrameMetaballs, StandBesideInstancesThatTheDevicePoses) {
  Crowd b({0, 0, 0}, 70);
  add_body(b, 2, {0.3, 0.2, -2.2});
  add_body(b, 1, {-0.6, -0.3, -3.2}, 0.2, 0.05);
  Job job = job_for(write(b), 96, 64);
  look(job, {0, 0, 0}, {0, 0, -1}, 60);
  std::optional<Image> posed_by_host;
  for (const char* enabled : {"0", "1"})
    for (const char* technique : {"clustered", "visibility"}) {
      job.technique = technique, job.settings = {{"pose_items", "enabled", enabled}};
      const Images images = images_of(job, {}, 0.5);
      if (std::string(technique) == "visibility") continue;  // no message of validation
      if (!posed_by_host) posed_by_host = images["beauty"];
      EXPECT_TRUE(images["beauty"] == *posed_by_host) << enabled;
    }
}

// In a closed room nothing of the sky is left: reflections take away all that shading lets through as far as the body
// leaves it open, because they ask about the same point and normal.
TEST_F(FrameMetaballs, ReflectNothingOfTheSkyInAClosedRoom) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json metal = {{"pbrMetallicRoughness", base_color(1, 1, 1)}};
  metal["pbrMetallicRoughness"]["metallicFactor"] = 1;
  metal["pbrMetallicRoughness"]["roughnessFactor"] = 0.3;
  Json black = unlit_material(0, 0, 0);
  black["doubleSided"] = true;
  add_body(b, add_material(b, metal), {0, 0, 0}, 0.7);
  const int wall = add_square_mesh(b, 20, add_material(b, black));
  for (const glm::dvec3 to : {glm::dvec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}})
    for (const double side : {-20.0, 20.0})
      add_node(b, {{"mesh", wall},
                   {"translation", {side * to.x, side * to.y, side * to.z}},
                   {"rotation", rotation_between({0, 0, 1}, to)}});
  Job job = job_of(write(b));
  job.effects = "reflections,occlusion", job.layers = {"ambient_specular"};
  job.look = look_file(R"({"reflections": {}, "occlusion": {"radius_m": 1},
      "sky": {"gradient": {"zenith": 1, "horizon": 1, "ground": 1}}})");
  for (const char* technique : {"clustered", "visibility"})
    for (const char* occlusion : {"traced", "rays", "screen"}) {
      job.technique = technique;
      job.settings = {{"reflections", "method", "traced"}, {"reflections", "roughest", "1"}};
      job.settings.insert(job.settings.end(), {{"occlusion", "method", occlusion}, {"occlusion", "rays", "16"}});
      float most = 0;
      for (const glm::vec4& v : images_of(job)["ambient_specular"].values<glm::vec4>())
        most = std::max(most, std::abs(v.x));
      EXPECT_LT(most, 1e-4f) << technique << " " << occlusion;
    }
}

TEST_F(FrameMetaballs, ScenesWithoutThemHoldNothingOfThem) {
  const auto session = open(job_for(scene("skinned"), 32, 24));
  const FrameResult result = render(*session);
  EXPECT_FALSE(holds(result, "metaball"));
  EXPECT_FALSE(holds(result, "posed.items"));
  for (const PlanPass& pass : result.plan->passes) EXPECT_NE(pass.name, "metaballs");
  // Nor frames in which no body has a surface.
  GltfBuilder b = alone();
  b.json["nodes"][1]["extensions"]["CANDELA_metaballs"]["threshold"] = 3;
  const auto none = open(job_of(write(b)));
  EXPECT_FALSE(holds(render(*none), "metaball"));
}

// Polygons of the frame, whatever frames were before it; and balls that move do not change the plan at every frame.
TEST_F(FrameMetaballs, FramesDependOnTheirTimeAlone) {
  const Job job = job_of(write(alone()));
  const auto session = open(job);
  std::set<std::string> plans;
  std::vector<Image> pictures;
  for (const double time_s : {0.0, 0.02, 0.04, 0.06, 0.08, 0.1}) {
    const FrameResult result = render(*session, time_s);
    plans.insert(result.plan_hash.hex());
    pictures.push_back(images(result)["beauty"]);
  }
  EXPECT_LE(plans.size(), 2u);
  EXPECT_TRUE(images_of(job, {}, 0.06)["beauty"] == pictures[3]);
  EXPECT_FALSE(pictures[3] == pictures[4]);
}

}  // namespace candela::test::frame_metaballs
