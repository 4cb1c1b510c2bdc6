#include <algorithm>

#include "frame_fixture.h"

// Rays to lights by a pass of their own (passes/shadows/light_rays.h) in whole frames: the pictures are those of rays
// that shading sends.
namespace candela::test {
namespace {

class FrameLightRays : public FrameTest {
 protected:
  static Job traced(const std::filesystem::path& path, const char* apart, std::vector<KnobSetting> settings = {}) {
    Job job = job_for(path, 64, 36);
    job.technique = "visibility";
    job.effects = "shadows";
    job.settings = std::move(settings);
    for (const KnobSetting& s : {KnobSetting{"local", "method", "traced"}, KnobSetting{"sun", "mode", "traced"},
                                 KnobSetting{"light_rays", "apart", apart}})
      job.settings.push_back(s);
    return job;
  }
  struct Drawn {
    std::shared_ptr<const FramePlan> plan;
    Image picture;
  };
  static Drawn drawn(const Job& job) {
    const auto session = open(job);
    EXPECT_TRUE(session);
    const FrameResult result = render(*session);
    return {result.plan, images(result)["beauty"]};
  }
  static bool holds(const Drawn& result, std::string_view pass) {
    return std::ranges::any_of(result.plan->passes, [&](const PlanPass& p) { return p.name.starts_with(pass); });
  }
  static bool shades_without_records(const Drawn& result) {
    return std::ranges::any_of(result.plan->pipelines, [](const PipelineDesc& p) {
      const auto* compute = std::get_if<ComputePipelineDesc>(&p);
      return compute && compute->shader.find("WITHOUT_RECORDS") != std::string::npos;
    });
  }
  // Both ways, to the bit.
  static Drawn expect_same(Job job) {
    job.settings.back().value = "off";
    const Drawn inside = drawn(job);
    EXPECT_FALSE(holds(inside, "light_rays"));
    job.settings.back().value = "on";
    Drawn apart = drawn(job);
    EXPECT_TRUE(holds(apart, "light_rays"));
    EXPECT_EQ(apart.picture, inside.picture);
    return apart;
  }

  // A floor with a square above it, of the material, a sun and two lamps.
  static std::string shaded(const Json& material) {
    GltfBuilder b = empty_scene();
    const int floor = add_square_mesh(b, 20, add_material(b, diffuse_material(0.8, 0.8, 0.8)));
    add_node(b, {{"mesh", floor}, {"rotation", rotation_between({0, 0, 1}, {0, 1, 0})}});
    const int square = add_square_mesh(b, 0.7f, add_material(b, material));
    add_node(b, {{"mesh", square}, {"rotation", rotation_between({0, 0, 1}, {0.2, 1, 0})}, {"translation", {0, 1, 0}}});
    for (const double x : {-1.0, 0.5})
      add_light(b, {{"type", "point"}, {"intensity", 100.0}}, {{"translation", {x, 3, 0.5}}});
    add_light(b, {{"type", "directional"}, {"intensity", 3.0}},
              {{"rotation", rotation_between({0, 0, -1}, glm::normalize(glm::dvec3(0.3, -1, -0.2)))}});
    return write(b);
  }
  static Job from_above(const std::string& path, std::vector<KnobSetting> settings = {}) {
    Job job = traced(path, "on", std::move(settings));
    look(job, {0, 5, 6}, {0, 0, 0}, 60);
    return job;
  }
};

// Many lights of which each point has its own, one and several samples a pixel, of one picture and of several.
TEST_F(FrameLightRays, DrawWhatShadingDraws) {
  expect_same(traced(scene("street"), "on"));
  Job multisampled = traced(scene("street"), "on");
  multisampled.samples = 4;
  expect_same(multisampled);
  expect_same(traced(scene("street"), "on", {{"supersample", "n", "4"}}));
}

// Lights with a size have several rays each, and blended surfaces let a part of them through.
TEST_F(FrameLightRays, KeepPenumbraeAndColours) {
  Json sheet = diffuse_material(0.9, 0.2, 0.1);
  sheet["alphaMode"] = "BLEND";
  sheet["pbrMetallicRoughness"]["baseColorFactor"] = {0.9, 0.2, 0.1, 0.6};
  for (const Json& material : {diffuse_material(0.5, 0.2, 0.1), sheet}) {
    Job job = from_above(shaded(material), {{"local", "samples", "5"}});
    job.look = look_file(R"({"lights": {"radius_m": 0.3}})");
    expect_same(job);
  }
}

// Light comes through the surface itself.
TEST_F(FrameLightRays, ReachBothSidesOfWhatLetsLightThrough) {
  Json leaf = diffuse_material(0.5, 0.2, 0.1);
  leaf["doubleSided"] = true;
  leaf["extensions"]["KHR_materials_diffuse_transmission"] = {{"diffuseTransmissionFactor", 0.7}};
  Job job = from_above(shaded(leaf));
  look(job, {0, 0.2, 3}, {0, 1, 0}, 60);
  expect_same(job);
}

// Pixels whose records find no room send their own rays.
TEST_F(FrameLightRays, DoWithoutRoom) {
  Job job = traced(scene("street"), "on", {{"light_rays", "budget_mb", "1"}});
  EXPECT_FALSE(shades_without_records(expect_same(traced(scene("spheres"), "on"))));
  job.width_px = 320, job.height_px = 180;
  EXPECT_TRUE(shades_without_records(expect_same(job)));
}

TEST_F(FrameLightRays, AreLeftOutWithAReason) {
  const std::string path = shaded(diffuse_material(0.5, 0.2, 0.1));
  Job maps = from_above(path), cells = maps, inside = from_above(path);
  maps.settings = {{"light_rays", "apart", "on"}};
  cells.settings[0].value = "voxels";
  inside.settings.back().value = "auto";  // the device here is a CPU
  for (const auto& [job, reason] :
       {std::pair(maps, "no light's shadows are traced (local.method, sun.mode)"),
        std::pair(cells, "cells of the view know some lights' shadows: shading sends the rays that they leave"),
        std::pair(inside, "shading sends the rays itself (light_rays.apart)")}) {
    const Drawn result = drawn(job);
    EXPECT_TRUE(std::ranges::any_of(result.plan->left_out, [&](const LeftOut& l) {
      return l.pass == "light_rays" && l.reason == reason;
    })) << reason;
  }
}

}  // namespace
}  // namespace candela::test
