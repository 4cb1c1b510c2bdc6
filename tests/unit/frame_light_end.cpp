#include "plan/light_end.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/rng.h"
#include "plan/choose_sides.h"
#include "plan/stand_ins.h"
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
// Of what arrives at a point of the floor, the part that is off, over the larger of it and least_lux. ended: first the
// lights, which have ends, then stand-ins.
double off_at(const std::vector<LightItem>& lights, const std::vector<LightItem>& ended, glm::dvec3 at,
              double least_lux) {
  const auto sum = [&](const std::vector<LightItem>& of) {
    double lux = 0;
    for (const LightItem& l : of) {
      const glm::dvec3 to = glm::dvec3(l.position) - at;
      const double d2 = glm::dot(to, to);
      lux += double(l.intensity.x) / d2 * to.z / std::sqrt(d2) * window_of(l, std::sqrt(d2));
    }
    return lux;
  };
  const double all = sum(lights);
  return std::abs(all - sum(ended)) / std::max(all, least_lux);
}

// The same of a point that only light from above reaches.
double off_above(std::vector<LightItem> lights, std::vector<LightItem> ended, glm::dvec3 at, double least_lux) {
  const auto is_below = [&](const LightItem& l) { return double(l.position.z) <= at.z; };
  std::erase_if(lights, is_below), std::erase_if(ended, is_below);
  return off_at(lights, ended, at, least_lux);
}

}  // namespace

// At points that did not choose the end: of one lamp, of few and of many dim ones, of which stand-ins give the rest.
TEST(LightEnd, LosesNoMoreThanItIsAskedFor) {
  for (const auto& [lamps, candela] :
       {std::pair(1, 100.0), {1, 0.01}, {16, 5.0}, {100, 0.05}, {500, 0.02}, {2000, 0.05}, {8000, 0.05}})
    for (const double most : {0.05, 0.02, 0.005}) {
      const Lit lit = floor_under(lamps, candela);
      const LightEnd end = choose_light_end(lit.scene, lit.data, most, 0, 0.01);
      EXPECT_GT(end.floor_lux, 0);
      std::vector<LightItem> ended = lit.data.lights;
      EXPECT_EQ(apply_light_end(ended, end), size_t(lamps));
      EXPECT_EQ(ended.size() > size_t(lamps), end.spacing > 0);
      Rng rng(77);
      double worst = 0, walked = 0;
      for (int i = 0; i < 1000; ++i) {
        const glm::dvec3 at{rng.uniform(-10, 10), rng.uniform(-10, 10), 0};
        worst = std::max(worst, off_at(lit.data.lights, ended, at, 0.01 * std::numbers::pi));
        for (const LightItem& l : ended)
          walked += glm::distance(glm::dvec3(l.position), at) < double(l.range_m) ? 1.0 / 1000 : 0.0;
      }
      if (lamps >= 2000) EXPECT_LT(walked, 0.6 * lamps);
      EXPECT_FALSE(end.held);
      EXPECT_LE(worst, most) << lamps << " of " << candela;
      EXPECT_LE(worst, 1.3 * end.lost + 0.5 * most) << lamps << " of " << candela;
    }
}

// Table tops amid a flat crowd, which get their light at grazing angles from the lamps that hang higher, however far
// off.
TEST(LightEnd, HoldsOnSurfacesAmidACrowd) {
  GltfBuilder b = empty_scene();
  const int grey = add_material(b, diffuse_material(0.8, 0.8, 0.8));
  add_node(b, {{"mesh", add_square_mesh(b, 10, grey)}});
  const int table = add_square_mesh(b, 0.4f, grey);
  Rng places(9);
  for (int i = 0; i < 24; ++i)
    add_node(b, {{"mesh", table}, {"translation", {places.uniform(-8, 8), places.uniform(-8, 8), 1.2}}});
  auto scene = b.load(LoadFor::raster);
  ASSERT_TRUE(scene);
  FrameData data = make_frame_data(*scene, evaluate_pose(*scene, {}, 0), View{});
  data.lights = floor_under(4096, 0.02).data.lights;
  const LightEnd end = choose_light_end(*scene, data, 0.02, 0, 0.01);
  EXPECT_GT(end.layers, 1);
  std::vector<LightItem> ended = data.lights;
  apply_light_end(ended, end);
  Rng rng(5);
  double worst = 0;
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 at{rng.uniform(-8, 8), rng.uniform(-8, 8), 1.2};
    worst = std::max(worst, off_above(data.lights, ended, at, 0.01 * std::numbers::pi));
  }
  EXPECT_LE(end.lost, 0.03);
  EXPECT_LE(worst, 0.04);
}

// Spots have no stand-ins; their lists may be as long as those of other lights and their stand-ins together.
TEST(LightEnd, SpotsHaveLongerLists) {
  Lit lit = floor_under(1000, 0.05);
  for (LightItem& l : lit.data.lights) {
    l.type = LightType::spot;
    l.direction = {0, 0, -1};
    l.inner_cone_rad = 0.5f, l.outer_cone_rad = 1.4f;
  }
  const LightEnd end = choose_light_end(lit.scene, lit.data, 0.05, 0, 0.01);
  EXPECT_EQ(end.spacing, 0);
  EXPECT_FALSE(end.held);
  EXPECT_LE(end.lost, 0.05);
}

TEST(LightEnd, IsNoneWithoutLightsOrWithoutALoss) {
  const Lit dark = floor_under(0, 1), lit = floor_under(3, 1);
  EXPECT_EQ(choose_light_end(dark.scene, dark.data, 0.01, 0, 0.01).floor_lux, 0);
  EXPECT_EQ(choose_light_end(lit.scene, lit.data, 0, 0, 0.01).floor_lux, 0);
  // Under a brighter exposure darker places count.
  EXPECT_LE(choose_light_end(lit.scene, lit.data, 0.01, 8, 0.01).floor_lux,
            choose_light_end(lit.scene, lit.data, 0.01, 0, 0.01).floor_lux);
}

// A lamp and what stands in for it give together what the lamp gave, at any distance.
TEST(StandIns, GiveWhatLightsNoLongerDo) {
  Lit lit = floor_under(0, 1);
  for (const float candela : {1e-12f, 1.0f, 3.0f, 1e12f}) {
    LightItem lamp{};
    lamp.type = LightType::point, lamp.intensity = {candela, 0.5f * candela, 0}, lamp.position = {1, 2, 3};
    lamp.range_m = std::numeric_limits<float>::infinity();
    lit.data.lights.push_back(lamp);
  }
  const std::vector<LightItem> before = lit.data.lights;
  std::vector<LightItem> after = before;
  EXPECT_EQ(end_with_stand_ins(after, 0.01f, 0.5), before.size());
  ASSERT_GT(after.size(), before.size());
  for (const double distance : {1e-3, 0.3, 1.0, 7.0, 1e3, 1e6, 1e12}) {
    glm::dvec3 sum(0), all(0);
    for (const LightItem& l : before) all += glm::dvec3(l.intensity);
    for (const LightItem& l : after) {
      EXPECT_EQ(l.position, before[0].position);
      EXPECT_GE(window_of(l, distance), 0);
      sum += glm::dvec3(l.intensity) * window_of(l, distance);
    }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], all[c], 1e-6 * all[c]) << distance;
  }
}

// They keep all intensity of a colour, lie among what they stand for, and move with it; other lights are left alone.
TEST(StandIns, StandAmidTheirLights) {
  Lit lit = floor_under(3000, 0.01);
  LightItem& sun = lit.data.lights[7];
  sun.type = LightType::directional;
  LightItem& spot = lit.data.lights[8];
  spot.type = LightType::spot;
  lit.data.lights[9].range_m = 2;
  lit.data.lights[10].position.x = std::numeric_limits<float>::infinity();
  const std::vector<LightItem> before = lit.data.lights;
  std::vector<LightItem> after = before, again = before, moved = before;
  EXPECT_EQ(end_with_stand_ins(after, 0.01f, 0.5), before.size() - 4);
  for (const size_t other : {7u, 8u, 9u, 10u}) EXPECT_EQ(after[other].range_m, before[other].range_m);
  const double inner = double(after[0].range_m);
  double first = 0, last = 0;
  for (size_t i = before.size(); i < after.size(); ++i) {
    EXPECT_GT(after[i].inner_m, 0);
    EXPECT_LE(std::abs(after[i].position.x), 10);
    EXPECT_GE(after[i].position.z, 0.5f);
    EXPECT_LE(after[i].position.z, 1.5f);
    if (double(after[i].inner_m) == inner) first += double(after[i].intensity.x);
    if (std::isinf(after[i].range_m)) last += double(after[i].intensity.x);
  }
  EXPECT_NEAR(first, 0.01 * double(before.size() - 4), 1e-3);
  EXPECT_NEAR(last, first, 1e-3);
  end_with_stand_ins(again, 0.01f, 0.5);
  for (LightItem& l : moved) l.position += glm::vec3(64, -32, 16);
  end_with_stand_ins(moved, 0.01f, 0.5);
  ASSERT_EQ(again.size(), after.size());
  ASSERT_EQ(moved.size(), after.size());
  for (size_t i = before.size(); i < after.size(); ++i) {
    EXPECT_EQ(again[i].position, after[i].position);
    EXPECT_LT(glm::distance(moved[i].position - glm::vec3(64, -32, 16), after[i].position), 1e-4f);
  }
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
