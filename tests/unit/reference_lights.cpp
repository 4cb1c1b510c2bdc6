#include <numbers>

#include "reference_fixture.h"

namespace candela::reference::test {
namespace {

using std::numbers::pi;

LightItem light_item(LightType type) {
  LightItem item{type};
  item.position = {1, 2, 3};
  item.direction = {0, -1, 0};
  item.intensity = {2, 4, 8};
  item.range_m = std::numeric_limits<float>::infinity();
  item.inner_cone_rad = 0.2f, item.outer_cone_rad = 0.5f;
  return item;
}

}  // namespace

TEST(PunctualLights, FollowTheSpecification) {
  const glm::dvec3 at(1, 0, 3);  // two metres below
  const Arrival point = arriving(punctual_light(light_item(LightType::point)), at);
  EXPECT_EQ(point.l, glm::dvec3(0, 1, 0));
  EXPECT_DOUBLE_EQ(point.distance_m, 2);
  EXPECT_EQ(point.illuminance, glm::dvec3(0.5, 1, 2));
  LightItem item = light_item(LightType::point);
  item.range_m = 4;  // (1 - (2/4)^4)/4
  EXPECT_DOUBLE_EQ(arriving(punctual_light(item), at).illuminance.x, 2 * (1 - 1.0 / 16) / 4);
  item.range_m = 2;
  EXPECT_EQ(arriving(punctual_light(item), at).illuminance, glm::dvec3(0));
  // Nearer than that the inverse square is held.
  const PunctualLight held = punctual_light(light_item(LightType::point), 0.01);
  EXPECT_DOUBLE_EQ(arriving(held, glm::dvec3(1, 2, 3)).illuminance.x, 2e4);
  const Arrival sun = arriving(punctual_light(light_item(LightType::directional)), at);
  EXPECT_EQ(sun.illuminance, glm::dvec3(2, 4, 8));
  EXPECT_EQ(sun.l, glm::dvec3(0, 1, 0));
}

TEST(PunctualLights, SpotsFadeBetweenTheirCones) {
  const PunctualLight spot = punctual_light(light_item(LightType::spot));
  const auto factor = [&](double radians) {
    const glm::dvec3 at = glm::dvec3(1, 2, 3) + glm::dvec3(std::sin(radians), -std::cos(radians), 0);
    return arriving(spot, at).illuminance.x / 2;
  };
  EXPECT_NEAR(factor(0), 1, 1e-6);
  EXPECT_NEAR(factor(0.199), 1, 1e-6);
  EXPECT_EQ(factor(0.501), 0);
  const double inner = std::cos(double(0.2f)), outer = std::cos(double(0.5f)),
               t = (std::cos(0.35) - outer) / (inner - outer);
  EXPECT_NEAR(factor(0.35), t * t, 1e-6);
}

TEST(LightTree, ChoosesWithTheProbabilitiesItStates) {
  std::vector<LightExtent> lights;
  for (int i = 0; i < 37; ++i) {
    LightExtent e;
    e.box.add(glm::dvec3(std::sin(i * 1.7) * 5, 1 + i % 4, std::cos(i * 2.3) * 5));
    e.power = 1 + i % 5;
    e.theta_o = i % 3 == 0 ? 0 : pi;
    e.theta_e = i % 3 == 0 ? 0.8 : 0;
    e.axis = {0, -1, 0};
    lights.push_back(e);
  }
  lights[7].power = 0;
  const LightTree tree(lights);
  const glm::dvec3 point(0.5, 0, 0.3), normal(0, 1, 0);
  std::vector<LightTree::Choice> chosen;
  for (const bool split : {false, true}) {
    double total = 0;
    std::vector<double> expected, counted(lights.size());
    for (uint32_t i = 0; i < lights.size(); ++i)
      expected.push_back(tree.probability(i, point, normal, split)), total += expected.back();
    EXPECT_EQ(expected[7], 0);
    constexpr int count = 1 << 15;
    double picks = 0;
    for (int i = 0; i < count; ++i) {
      tree.choose(point, normal, (i + 0.5) / count, split, chosen);
      ASSERT_FALSE(chosen.empty());
      picks += double(chosen.size()) / count;
      for (const LightTree::Choice& choice : chosen) {
        ASSERT_NEAR(choice.probability, expected[choice.light], 1e-9);
        counted[choice.light] += 1.0 / count;
      }
    }
    for (size_t i = 0; i < lights.size(); ++i) EXPECT_NEAR(counted[i], expected[i], 1e-3) << i;
    EXPECT_NEAR(picks, total, 1e-2);
    if (split)
      EXPECT_GT(picks, 1.5);
    else
      EXPECT_NEAR(total, 1, 1e-9);
  }
  tree.choose(point, {0, -1, 0}, 0.5, true, chosen);
  EXPECT_TRUE(chosen.empty()) << "all lights are behind this surface";
}

TEST(LightTree, LeavesOutWhatCannotReach) {
  LightExtent near, far;
  near.box.add(glm::dvec3(0, 1, 0)), near.power = 1e-6, near.theta_o = pi;
  far.box.add(glm::dvec3(0, 50, 0)), far.power = 1e6, far.theta_o = pi, far.range_m = 40;
  const LightTree tree({near, far});
  EXPECT_EQ(tree.probability(0, {0, 0, 0}, {0, 1, 0}, false), 1);
  EXPECT_EQ(tree.probability(1, {0, 0, 0}, {0, 1, 0}, true), 0);
  EXPECT_GT(tree.probability(1, {0, 10.5, 0}, {0, 1, 0}, true), 0) << "half a metre within its range";
}

TEST(LightTree, ConesHoldBoth) {
  glm::dvec3 axis;
  double theta = 0;
  merge_cones({1, 0, 0}, 0.2, {0, 1, 0}, 0.3, axis, theta);
  EXPECT_NEAR(theta, (0.2 + pi / 2 + 0.3) / 2, 1e-12);
  EXPECT_NEAR(std::acos(glm::dot(axis, glm::dvec3(1, 0, 0))) + 0.2, theta, 1e-9);
  EXPECT_NEAR(std::acos(glm::dot(axis, glm::dvec3(0, 1, 0))) + 0.3, theta, 1e-9);
  merge_cones({1, 0, 0}, 1, {1, 0, 0}, 0.3, axis, theta);
  EXPECT_EQ(theta, 1);
  merge_cones({1, 0, 0}, 0, {-1, 0, 0}, 0, axis, theta);
  EXPECT_EQ(theta, pi);
}

// Choosing one of many lights has the sum of all as its mean.
TEST(LightTree, EstimatesTheSumOfAllLights) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, diffuse_material(0.8, 0.5, 0.2)))}});
  for (int i = 0; i < 60; ++i) {
    Json light = {
        {"type", i % 3 == 2 ? "spot" : "point"}, {"intensity", 1.0 + i % 4}, {"color", {1, 0.5, 0.25 * (i % 4)}}};
    if (i % 3 == 2) light["spot"] = Json::object();
    if (i % 4 == 0) light["range"] = 2.5;
    add_light(b, light, {{"translation", {std::sin(i * 3.1) * 3, std::cos(i * 1.3) * 3, 0.4 + 0.3 * (i % 3)}}});
  }
  const TestCamera camera;
  const auto t = make_world(b, camera);
  const Film exact = traced(*t, centred(), camera, 1), direct = traced(*t, TraceSettings{}, camera, 64);
  const Film path = traced(*t, path_settings(1), camera, 256);
  for (int c = 0; c < 3; ++c) {
    const MeanError all = mean_of(direct, c), one = mean_of(path, c);
    EXPECT_GT(all.mean, 0.05);
    EXPECT_NEAR(one.mean, all.mean, 5 * one.error + 5e-4 * all.mean) << c;
    EXPECT_NEAR(mean_of(exact, c).mean, all.mean, 0.02 * all.mean);
  }
}

}  // namespace candela::reference::test
