#include "plan/light_end.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/rng.h"
#include "passes/lights/light_grid.h"
#include "plan/choose_sides.h"
#include "scene_pieces.h"

namespace candela::frame_light_end {
namespace {

using namespace candela::test;

struct Lit {
  Scene scene;
  FrameData data;
};
// A floor of half size 10 under lamps on a grid a metre above it.
Lit floor_under(int lamps, double candela) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", add_square_mesh(b, 10, add_material(b, diffuse_material(0.8, 0.8, 0.8)))}});
  auto scene = b.load(LoadFor::raster);
  EXPECT_TRUE(scene);
  Lit lit{std::move(*scene), {}};
  lit.data = make_frame_data(lit.scene, evaluate_pose(lit.scene, {}, 0), View{});
  Rng rng(3);
  for (int i = 0; i < lamps; ++i) {
    LightItem light{};
    light.type = LightType::point;
    light.position = {float(rng.uniform(-10, 10)), float(rng.uniform(-10, 10)), float(rng.uniform(0.5, 1.5))};
    light.intensity = glm::vec3(float(candela));
    light.range_m = std::numeric_limits<float>::infinity();
    lit.data.lights.push_back(light);
  }
  return lit;
}
// Of what arrives at a point of the floor, the fraction that is lost, over the larger of it and least_lux.
double lost_at(const std::vector<LightItem>& lights, glm::dvec3 at, double least_lux) {
  double all = 0, kept = 0;
  for (const LightItem& l : lights) {
    const glm::dvec3 to = glm::dvec3(l.position) - at;
    const double d2 = glm::dot(to, to), lux = double(l.intensity.x) / d2 * to.z / std::sqrt(d2);
    all += lux;
    const double x2 = d2 / (double(l.range_m) * double(l.range_m));
    kept += lux * std::max(1 - x2 * x2, 0.0);
  }
  return (all - kept) / std::max(all, least_lux);
}

}  // namespace

// At points that did not choose the end: of one lamp, of few and of many dim ones, as far as lists may grow.
TEST(LightEnd, LosesNoMoreThanItIsAskedFor) {
  for (const auto& [lamps, candela] : {std::pair(1, 100.0), {1, 0.01}, {16, 5.0}, {100, 0.05}, {500, 0.02}})
    for (const double most : {0.05, 0.02, 0.005}) {
      Lit lit = floor_under(lamps, candela);
      const LightEnd end = choose_light_end(lit.scene, lit.data, most, 0, 0.01);
      EXPECT_GT(end.floor_lux, 0);
      EXPECT_EQ(apply_light_floor(lit.data.lights, end.floor_lux), uint32_t(lamps));
      Rng rng(77);
      double worst = 0;
      for (int i = 0; i < 1000; ++i)
        worst = std::max(
            worst, lost_at(lit.data.lights, {rng.uniform(-10, 10), rng.uniform(-10, 10), 0}, 0.01 * std::numbers::pi));
      if (!end.held)
        EXPECT_LE(worst, most) << lamps << " of " << candela;
      else
        EXPECT_GT(end.lost, most);
      EXPECT_LE(worst, 1.3 * end.lost + 0.5 * most) << lamps << " of " << candela;
    }
}

TEST(LightEnd, IsNoneWithoutLightsOrWithoutALoss) {
  const Lit dark = floor_under(0, 1), lit = floor_under(3, 1);
  EXPECT_EQ(choose_light_end(dark.scene, dark.data, 0.01, 0, 0.01).floor_lux, 0);
  EXPECT_EQ(choose_light_end(lit.scene, lit.data, 0, 0, 0.01).floor_lux, 0);
  // Under a brighter exposure darker places count.
  EXPECT_LE(choose_light_end(lit.scene, lit.data, 0.01, 8, 0.01).floor_lux,
            choose_light_end(lit.scene, lit.data, 0.01, 0, 0.01).floor_lux);
}

// A wall that is seen from behind is looked through, and one from the front or of two sides is not.
TEST(ChooseSides, OpensWhereTheCameraLooksThroughBacks) {
  for (const auto& [z, double_sided, expected] :
       {std::tuple(4.0, false, "block"), {-4.0, false, "open"}, {-4.0, true, "block"}}) {
    GltfBuilder b = empty_scene();
    Json material = diffuse_material(0.8, 0.8, 0.8);
    material["doubleSided"] = double_sided;
    add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, material))}});
    const auto scene = b.load(LoadFor::raster);
    ASSERT_TRUE(scene);
    Job job;
    job.camera.eye = {0, 0, z}, job.camera.target = {0, 0, 0};
    const ChosenSides chosen = choose_sides(*scene, job);
    EXPECT_EQ(chosen.name, expected) << z << double_sided;
    EXPECT_EQ(chosen.why.empty(), chosen.name == "block");
  }
}

}  // namespace candela::frame_light_end
