// Paths where light passes single-sided faces from behind (--sides open).
#include "base/rng.h"
#include "reference_fixture.h"

namespace candela::reference::test::reference_sides {
namespace {

// The same scene whose sides are open or block.
std::unique_ptr<TestWorld> world_of(const GltfBuilder& b, const TestCamera& camera, const Sky& sky, bool open,
                                    std::optional<Fog> fog = {}) {
  auto t = make_world(b, camera);
  WorldInput input{t->scene, t->pose, t->view, t->frame};
  input.sky = sky, input.fog = fog, input.open_sides = open;
  t->world = std::make_unique<World>(input, t->warnings);
  return t;
}
Json double_sided(Json material) {
  material["doubleSided"] = true;
  return material;
}
void add_lamp(GltfBuilder& b, double radius_m, double candela, glm::dvec3 at) {
  Json light = {{"type", "point"}, {"intensity", candela}};
  if (radius_m > 0) light["extensions"]["CANDELA_light_size"]["radius"] = radius_m;
  add_light(b, light, {{"translation", {at.x, at.y, at.z}}});
  use_all(b);
  b.json["extensionsUsed"].push_back("CANDELA_light_size");
}
const Sky white = Sky::constant(glm::dvec3(1));
MeanError mean_by(const TestWorld& t, const TestCamera& camera, Strategy strategy, int spp, bool lamp_rays = true) {
  TraceSettings settings = path_settings(4);
  settings.strategy = strategy, settings.lamp_rays = lamp_rays, settings.sampler.seed = 7 + uint64_t(strategy);
  return mean_of(traced(t, settings, camera, spp));
}

}  // namespace

// A closed body lets nothing through that goes in at one side and has to leave at the other: not a bit is another.
TEST(Sides, ClosedBodiesAreTheSameToTheBit) {
  GltfBuilder b = empty_scene();
  use_all(b);
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, double_sided(diffuse_material(0.7, 0.6, 0.5))))}});
  const int body = add_sphere_mesh(b, 0.5f, add_material(b, diffuse_material(0.3, 0.6, 0.9)), 8);
  add_node(b, {{"mesh", body}, {"translation", {0.1, 0, 0.7}}});
  const int lamp = add_sphere_mesh(b, 0.1f, add_material(b, emitting(diffuse_material(0, 0, 0), 5)), 4);
  add_node(b, {{"mesh", lamp}, {"translation", {-1, 0.5, 0.8}}});
  add_lamp(b, 0, 2, {1, 0.5, 1.5});
  add_lamp(b, 0.1, 2, {0.5, -1, 1});
  const TestCamera camera{.eye = {0, -3, 2}, .target = {0, 0, 0.5}};
  Film film[2] = {traced(*world_of(b, camera, white, false), path_settings(), camera, 64),
                  traced(*world_of(b, camera, white, true), path_settings(), camera, 64)};
  EXPECT_GT(mean_of(film[0]).mean, 0.1);
  for (size_t i = 0; i < film[0].pixels(); ++i) EXPECT_EQ(film[1].mean(i), film[0].mean(i)) << i;
}

// A room whose walls all face inwards has the sky for its walls: each reflects that, and nothing twice. Blocked it is
// dark, and would be so much brighter as 1 / (1 - albedo) if its walls sent each other the sky's light besides.
TEST(Sides, ARoomTurnedInsideOutReflectsTheSkyOnce) {
  for (const double albedo : {0.5, 1.0}) {
    GltfBuilder b = empty_scene();
    use_all(b);
    add_node(b, {{"mesh", add_room_mesh(b, 1, add_material(b, diffuse_material(albedo, albedo, albedo)))}});
    const TestCamera camera{.eye = {0.2, 0.1, 0.3}, .target = {0.3, -0.9, -1}, .width = 8, .height = 8};
    EXPECT_EQ(mean_of(traced(*world_of(b, camera, white, false), path_settings(8), camera, 16)).mean, 0);
    const auto t = world_of(b, camera, white, true);
    for (const Strategy strategy : {Strategy::both, Strategy::light, Strategy::brdf}) {
      const MeanError m = mean_by(*t, camera, strategy, 256);
      EXPECT_NEAR(m.mean, albedo, 5 * m.error + 1e-3) << int(strategy);
      EXPECT_LT(m.error, 0.02);
    }
  }
}

// A floor under a wide roof of one side. The roof faces down: the floor lies as in the open, and the roof reflects what
// the floor does. It faces up: it is a roof, as it is where sides block.
TEST(Sides, AFloorUnderARoofOfOneSide) {
  const double floor_albedo = 0.8, roof_albedo = 0.5;
  const auto radiance = [&](bool faces_up, bool from_above, bool open, Strategy strategy) {
    GltfBuilder b = empty_scene();
    use_all(b);
    const int floor = add_material(b, double_sided(diffuse_material(floor_albedo, floor_albedo, floor_albedo)));
    const int roof = add_material(b, diffuse_material(roof_albedo, roof_albedo, roof_albedo));
    add_node(b, {{"mesh", add_square_mesh(b, 400, floor)}});
    const Json turn = faces_up ? Json{0, 0, 0, 1} : Json{1, 0, 0, 0};
    add_node(b, {{"mesh", add_square_mesh(b, 400, roof)}, {"translation", {0, 0, 2}}, {"rotation", turn}});
    TestCamera camera{.eye = {0, 0.1, 4}, .target = {0, 0, 0}, .yfov_deg = 10, .width = 4, .height = 4};
    if (!from_above) camera.eye = {0, 0.1, 0.5}, camera.target = {0, 0, 2};
    return mean_by(*world_of(b, camera, white, open), camera, strategy, 256);
  };
  for (const Strategy strategy : {Strategy::both, Strategy::light, Strategy::brdf}) {
    // Its back is looked through.
    MeanError m = radiance(false, true, true, strategy);
    EXPECT_NEAR(m.mean, floor_albedo, 5 * m.error + 5e-3) << "the floor through the roof";
    m = radiance(false, false, true, strategy);
    EXPECT_NEAR(m.mean, roof_albedo * floor_albedo, 5 * m.error + 5e-3) << "the roof from below";
    m = radiance(false, true, false, strategy);
    EXPECT_LT(m.mean, 0.02) << "the floor, blocked";
    for (const bool open : {true, false}) {
      m = radiance(true, true, open, strategy);
      EXPECT_NEAR(m.mean, roof_albedo, 5 * m.error + 5e-3) << "the roof from above";
    }
  }
}

// Single-sided squares without order, white, in a white furnace.
TEST(Sides, AFurnaceOfOneSidedFacesGainsNothing) {
  GltfBuilder b = empty_scene();
  use_all(b);
  const int mesh = add_square_mesh(b, 0.6f, add_material(b, diffuse_material(1, 1, 1)));
  Rng rng(5);
  for (int i = 0; i < 40; ++i) {
    const glm::dvec3 at(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    const glm::dvec3 to(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    add_node(b, {{"mesh", mesh}, {"translation", {at.x, at.y, at.z}}, {"rotation", rotation_between({0, 0, 1}, to)}});
  }
  const TestCamera camera{.eye = {0, 0, 4}, .width = 12, .height = 12};
  const auto t = world_of(b, camera, white, true);
  for (const Strategy strategy : {Strategy::both, Strategy::light, Strategy::brdf}) {
    TraceSettings settings = path_settings();
    settings.strategy = strategy;
    const Film film = traced(*t, settings, camera, 256);
    for (size_t i = 0; i < film.pixels(); ++i)
      EXPECT_LE(film.mean(i).x, 1 + 5 * std::sqrt(film.variance(i).x) + 1e-9) << int(strategy) << " " << i;
    EXPECT_GT(mean_of(film).mean, 0.3);
  }
}

// Lights of every kind beyond walls that they come through: lamps with and without a size, a sky, what glows, a sun,
// through blended sheets, and in fog. Chosen at surfaces, met by scattered rays, and both: one mean. Bounces made from
// lamps as well change nothing.
TEST(Sides, EveryWayToMeetALightHasOneMean) {
  for (const bool foggy : {false, true}) {
    GltfBuilder b = empty_scene();
    use_all(b);
    Json glossy = {{"pbrMetallicRoughness", base_color(0.6, 0.5, 0.4)}};
    glossy["pbrMetallicRoughness"]["roughnessFactor"] = 0.5;
    add_node(b, {{"mesh", add_room_mesh(b, 1, add_material(b, glossy))}});
    Json glows = emitting(diffuse_material(0.2, 0.2, 0.2), 3);
    add_node(b, {{"mesh", add_square_mesh(b, 0.8f, add_material(b, glows))},
                 {"translation", {0, 0, 1.5}},
                 {"rotation", {1, 0, 0, 0}}});
    add_node(b, {{"mesh", add_square_mesh(b, 0.5f, add_material(b, double_sided(diffuse_material(0.5, 0.5, 0.5))))},
                 {"translation", {-0.4, 0, 1.3}}});
    Json sheet = double_sided(diffuse_material(0.3, 0.3, 0.3));
    sheet["alphaMode"] = "BLEND", sheet["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.4;
    add_node(b, {{"mesh", add_square_mesh(b, 0.6f, add_material(b, sheet))}, {"translation", {0.4, 0, 1.2}}});
    const int body = add_sphere_mesh(b, 0.3f, 0, 6);
    add_node(b, {{"mesh", body}, {"translation", {0.3, 0.3, -0.6}}});
    add_lamp(b, 0.3, 3, {-1.6, 0.3, 0.2});
    add_lamp(b, 0.1, 0.3, {0.5, -0.5, 0.3});
    const TestCamera camera{.eye = {0.2, 0.6, 0.8}, .target = {0.3, -0.9, -1}, .yfov_deg = 80, .width = 8, .height = 8};
    std::optional<Fog> fog;
    if (foggy) {
      fog.emplace();
      fog->extinction_per_m = glm::dvec3(0.2), fog->scattering_per_m = glm::dvec3(0.15), fog->anisotropy = 0.3;
      fog->lowest = glm::dvec3(-4), fog->highest = glm::dvec3(4);
    }
    const auto t = world_of(b, camera, upper_half(), true, fog);
    const int spp = 512;
    const MeanError both = mean_by(*t, camera, Strategy::both, spp);
    EXPECT_GT(both.mean, 0.05);
    EXPECT_LT(both.error, 0.02 * both.mean);
    for (const MeanError other : {mean_by(*t, camera, Strategy::light, spp), mean_by(*t, camera, Strategy::brdf, spp),
                                  mean_by(*t, camera, Strategy::both, spp, false)})
      EXPECT_NEAR(other.mean, both.mean, 5 * std::hypot(other.error, both.error)) << foggy << " " << other.error;
  }
}

}  // namespace candela::reference::test::reference_sides
