// Bounces that are made from lamps as well.
#include "reference_fixture.h"

namespace candela::reference::test::reference_lamp_paths {
namespace {

void add_lamp(GltfBuilder& b, double radius_m, double candela, glm::dvec3 at, Json light = {{"type", "point"}}) {
  light["intensity"] = candela;
  if (radius_m > 0) light["extensions"]["CANDELA_light_size"]["radius"] = radius_m;
  add_light(b, light, {{"translation", {at.x, at.y, at.z}}});
  use_all(b);
  b.json["extensionsUsed"].push_back("CANDELA_light_size");
}

}  // namespace

// A room with lamps close to walls and boxes, against paths that make every bounce themselves.
TEST(LampPaths, HaveTheMeanOfPathsWithoutThem) {
  for (const double radius : {0.0, 0.04}) {
    GltfBuilder b = empty_scene();
    use_all(b);
    Json shiny = {{"pbrMetallicRoughness", base_color(0.7, 0.6, 0.5)}};
    shiny["pbrMetallicRoughness"]["roughnessFactor"] = 0.5;
    Json sheet = {
        {"pbrMetallicRoughness", base_color(0.5, 0.5, 0.5, 0.4)}, {"alphaMode", "BLEND"}, {"doubleSided", true}};
    add_node(b, {{"mesh", add_room_mesh(b, 1.5f, add_material(b, diffuse_material(0.7, 0.6, 0.5)))}});
    add_node(b, {{"mesh", add_square_mesh(b, 0.5f, add_material(b, shiny))}, {"translation", {0.4, 0.2, -0.6}}});
    add_node(b, {{"mesh", add_square_mesh(b, 0.4f, add_material(b, sheet))}, {"translation", {-0.5, -0.2, -0.9}}});
    add_lamp(b, radius, 0.5, {0.3, 0.2, -0.3});
    add_lamp(b, radius, 1, {-0.5, 1.2, -0.4});
    add_lamp(b, radius, 2, {1.0, -0.9, 0.5}, {{"type", "spot"}, {"spot", {{"outerConeAngle", 0.8}}}, {"range", 4}});
    const TestCamera camera{.eye = {0, 0, 1.4}, .yfov_deg = 80};
    const auto t = make_world(b, camera);
    MeanError m[2], two[2];
    for (const bool with : {false, true}) {
      TraceSettings settings = path_settings(5);
      settings.lamp_rays = with, settings.sampler.seed = 5;
      m[with] = mean_of(traced(*t, settings, camera, 1024));
      settings.most_bounces = 2;
      two[with] = mean_of(traced(*t, settings, camera, 1024));
    }
    EXPECT_GT(m[1].mean, 0.05);
    EXPECT_NEAR(m[1].mean, m[0].mean, 5 * std::hypot(m[0].error, m[1].error)) << radius;
    EXPECT_NEAR(two[1].mean, two[0].mean, 5 * std::hypot(two[0].error, two[1].error)) << radius;
    EXPECT_LT(m[1].error, 0.01 * m[1].mean);
  }
}

// A lamp a finger's breadth above a plate that the camera does not see from its lit side: what the plate sends to a
// wall is the plate's hot spot alone. Paths of the wall that find it by chance are one in thousands.
TEST(LampPaths, FindWhatALampLightsCloseToIt) {
  GltfBuilder b = empty_scene();
  use_all(b);
  const int white = add_material(b, diffuse_material(0.8, 0.8, 0.8));
  const int mesh = add_square_mesh(b, 2, white);
  add_node(b, {{"mesh", mesh}});
  add_node(b, {{"mesh", add_square_mesh(b, 1, white)}, {"translation", {0, 0, 2}}, {"rotation", {1, 0, 0, 0}}});
  add_lamp(b, 0, 0.1, {0, 0, 1.98});
  const TestCamera camera{.eye = {0, -6, 1}, .target = {0, 0, 0}, .yfov_deg = 20};
  const auto t = make_world(b, camera);
  double error[2], mean[2];
  for (const bool with : {false, true}) {
    TraceSettings settings = path_settings(2);
    settings.lamp_rays = with;
    const MeanError m = mean_of(traced(*t, settings, camera, 1024));
    error[with] = m.error, mean[with] = m.mean;
  }
  EXPECT_LT(error[1], 0.2 * error[0]);
  EXPECT_NEAR(mean[1], mean[0], 5 * std::hypot(error[0], error[1]));
}

}  // namespace candela::reference::test::reference_lamp_paths
