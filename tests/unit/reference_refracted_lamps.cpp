// Lamps without a size that shine through bodies of smooth glass: light whose amount is known.
#include <fmt/format.h>

#include "reference_fixture.h"

namespace candela::reference::test {
namespace {

using std::numbers::pi;

void add_lamp(GltfBuilder& b, double radius_m, double candela, glm::dvec3 at) {
  Json light = {{"type", "point"}, {"intensity", candela}};
  if (radius_m > 0) light["extensions"]["CANDELA_light_size"]["radius"] = radius_m;
  add_light(b, light, {{"translation", {at.x, at.y, at.z}}});
  use_all(b);
  b.json["extensionsUsed"].push_back("CANDELA_light_size");
}
std::unique_ptr<TestWorld> dark_world(const GltfBuilder& b, const TestCamera& camera) {
  return make_world(b, camera, {}, false, glm::dvec4(0), true);
}

double reflectance(double cosine, double n) {
  const double behind = std::sqrt(1 - (1 - cosine * cosine) / (n * n));
  const double s = (cosine - n * behind) / (cosine + n * behind), p = (n * cosine - behind) / (n * cosine + behind);
  return (s * s + p * p) / 2;
}

// Illuminance at a distance from the axis below a lamp, `air` metres in air and `glass` in a slab across the way: flux
// of the lamp between two angles over the ring of the floor that it meets.
double below_slab(double radius, double candela, double air, double glass, double n, double left_per_m) {
  const auto at = [&](double angle) {
    const double inside = std::asin(std::sin(angle) / n);
    return air * std::tan(angle) + glass * std::tan(inside);
  };
  double low = 0, high = pi / 2 - 1e-9;
  for (int i = 0; i < 200; ++i) (at((low + high) / 2) < radius ? low : high) = (low + high) / 2;
  const double angle = (low + high) / 2, c = std::cos(angle), inside = std::cos(std::asin(std::sin(angle) / n));
  const double r = reflectance(c, n), widening = air / (c * c) + glass * c / (n * inside * inside * inside);
  return candela * (1 - r) * (1 - r) * std::pow(left_per_m, glass / inside) * std::sin(angle) / (radius * widening);
}

// Right-angled in x and z, its right angle at (1, -1), long in y; flat walls.
int add_prism_mesh(GltfBuilder& b, int material) {
  std::vector<float> position, normal;
  std::vector<uint16_t> index;
  const auto face = [&](std::vector<glm::vec3> corners, glm::vec3 n) {
    const uint16_t first = uint16_t(position.size() / 3);
    for (const glm::vec3& c : corners)
      for (int i = 0; i < 3; ++i) position.push_back(c[i]), normal.push_back(n[i]);
    const bool turned = glm::dot(glm::cross(corners[1] - corners[0], corners[2] - corners[0]), n) < 0;
    for (uint16_t k = 2; k < corners.size(); ++k)
      for (const int at : {0, turned ? k : k - 1, turned ? k - 1 : k}) index.push_back(uint16_t(first + at));
  };
  const float h = std::sqrt(0.5f);
  face({{1, -4, -1}, {1, 4, -1}, {1, 4, 1}, {1, -4, 1}}, {1, 0, 0});
  face({{-1, -4, -1}, {-1, 4, -1}, {1, 4, -1}, {1, -4, -1}}, {0, 0, -1});
  face({{-1, -4, -1}, {-1, 4, -1}, {1, 4, 1}, {1, -4, 1}}, {-h, 0, h});
  for (const float y : {-4.0f, 4.0f}) face({{1, y, -1}, {-1, y, -1}, {1, y, 1}}, {0, y / 4, 0});
  const int p = b.accessor<float>("VEC3", position), n = b.accessor<float>("VEC3", normal);
  Json& primitive = b.primitive({{"POSITION", p}, {"NORMAL", n}});
  primitive["indices"] = b.accessor<uint16_t>("SCALAR", index);
  primitive["material"] = material;
  return int(b.json["meshes"].size()) - 1;
}

}  // namespace

// Pixel by pixel, and without noise: the straight direction leads to the one way there is.
TEST(RefractedLamps, TheSlab) {
  for (const bool absorbs : {false, true}) {
    GltfBuilder b = empty_scene();
    Json material = glass_material(1.5, 0, 1);
    if (absorbs) material = absorbing(material, 1, glm::dvec3(0.4));
    add_slab(b, 40, 0.5, add_material(b, material));
    add_node(b, {{"mesh", add_square_mesh(b, 40, add_material(b, diffuse_material(0.5, 0.5, 0.5)))},
                 {"translation", {0, 0, -1.5}}});
    add_lamp(b, 0, 10, {0, 0, 1});
    const TestCamera camera{.eye = {0.3, 0.2, -0.6}, .target = {0.3, 0.2, -1.5}, .yfov_deg = 100};
    const auto t = dark_world(b, camera);
    TraceSettings settings = centred(Mode::path);
    settings.most_bounces = 3;
    const Film film = traced(*t, settings, camera, 1);
    for (size_t i = 0; i < film.pixels(); ++i) {
      TestCamera flat = camera;
      flat.eye.z = 0.9;
      const glm::dvec3 at = seen_on_plane(flat, i);
      const double lux = below_slab(std::hypot(at.x, at.y), 10, 2, 0.5, 1.5, absorbs ? 0.4 : 1);
      EXPECT_NEAR(film.mean(i).x, 0.5 / pi * lux, 2e-5 * lux) << absorbs << " " << i;
    }
    // One wall fewer than the way has.
    settings.most_bounces = 2;
    EXPECT_EQ(mean_of(traced(*t, settings, camera, 1)).mean, 0);
  }
}

// Colours that the glass splits come each by its own way.
TEST(RefractedLamps, TheDispersiveSlab) {
  GltfBuilder b = empty_scene();
  Json material = glass_material(1.5, 0, 1);
  material["extensions"]["KHR_materials_dispersion"] = {{"dispersion", 20}};
  add_slab(b, 40, 4, add_material(b, material));
  add_node(b, {{"mesh", add_square_mesh(b, 40, add_material(b, diffuse_material(0.5, 0.5, 0.5)))},
               {"translation", {0, 0, -5}}});
  add_lamp(b, 0, 100, {0, 0, 1});
  const TestCamera camera{.eye = {3, 0, -4.5}, .target = {3, 0, -5}, .yfov_deg = 0.01, .width = 4, .height = 4};
  TraceSettings settings = path_settings(3);
  const Film film = traced(*dark_world(b, camera), settings, camera, 512);
  double mean[3];
  for (int c = 0; c < 3; ++c) {
    const MeanError m = mean_of(film, c);
    mean[c] = 0.5 / pi * below_slab(3, 100, 2, 4, 1.5 + (c - 1) * 0.5 * 0.025 * 20, 1);
    EXPECT_NEAR(m.mean, mean[c], 5 * m.error) << c;
    EXPECT_LT(m.error, 0.02 * m.mean);
  }
  EXPECT_GT(std::abs(mean[2] - mean[0]), 0.1 * mean[1]);
}

// A ball throws its light on a plane behind it: as much as photons of the lamp bring that are followed through a true
// sphere, two walls each.
TEST(RefractedLamps, TheFluxThroughABallIsThatOfPhotons) {
  constexpr double n = 1.5, candela = 10, lamp_z = 3, plane_z = -2, eye_z = -1.05;
  // Beside the axis, where all rays of a ring meet: light without bound, whose mean takes many samples.
  constexpr double aside = 0.9;
  const TestCamera camera{
      .eye = {aside, 0, eye_z}, .target = {aside, 0, plane_z}, .yfov_deg = 74, .width = 24, .height = 24};
  const double half = (eye_z - plane_z) * std::tan(37 * pi / 180);
  double photons = 0;
  constexpr int rings = 4000, sectors = 360;
  const double widest = 1 - std::sqrt(1 - 1 / (lamp_z * lamp_z));
  for (int i = 0; i < rings; ++i) {
    const double down = widest * (i + 0.5) / rings, cosine = 1 - down;
    glm::dvec3 d(std::sqrt(1 - cosine * cosine), 0, -cosine), p(0, 0, lamp_z);
    double left = 1;
    for (const double eta : {n, 1 / n}) {
      const double along = glm::dot(p, d), inside = along * along - (glm::dot(p, p) - 1);
      p += d * (eta > 1 ? -along - std::sqrt(inside) : -2 * along);
      const glm::dvec3 normal = eta > 1 ? p : -p;
      const double c = -glm::dot(d, normal);
      left *= 1 - reflectance(c, eta);
      d = d / eta + (c / eta - std::sqrt(1 - (1 - c * c) / (eta * eta))) * normal;
      p = glm::normalize(p);
    }
    if (!(d.z < 0)) continue;
    const glm::dvec3 at = p + d * ((plane_z - p.z) / d.z);
    for (int j = 0; j < sectors; ++j) {
      const double turn = 2 * pi * (j + 0.5) / sectors;
      if (std::max(std::abs(at.x * std::cos(turn) - aside), std::abs(at.x * std::sin(turn))) < half)
        photons += left * candela * 2 * pi * widest / rings / sectors;
    }
  }
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", add_sphere_mesh(b, 1, add_material(b, glass_material(n, 0, 1)), 64)}});
  add_node(b, {{"mesh", add_square_mesh(b, 6, add_material(b, diffuse_material(0.5, 0.5, 0.5)))},
               {"translation", {0, 0, plane_z}}});
  add_lamp(b, 0, candela, {0, 0, lamp_z});
  const auto t = dark_world(b, camera);
  EXPECT_TRUE(t->world->bends_lamps());
  const MeanError m = mean_of(traced(*t, path_settings(3), camera, 64));
  const double scale = pi / 0.5 * 4 * half * half;
  RecordProperty("photons", fmt::format("{}", photons));
  RecordProperty("found", fmt::format("{} {}", m.mean * scale, m.error * scale));
  EXPECT_NEAR(m.mean * scale, photons, 5 * m.error * scale + 0.005 * photons);
  EXPECT_LT(m.error, 0.01 * m.mean);
}

// The same light as of a lamp with a size, which plain paths meet, where no focus makes its size matter; by the ways
// that both know.
TEST(RefractedLamps, AreTheLimitOfLampsWithASize) {
  MeanError m[2];
  for (const bool sized : {false, true}) {
    GltfBuilder b = empty_scene();
    add_node(b, {{"mesh", add_sphere_mesh(b, 1, add_material(b, glass_material(1.2, 0, 1)), 24)},
                 {"scale", {1, 0.8, 1.1}},
                 {"translation", {0.2, 0, 0}}});
    add_node(b, {{"mesh", add_square_mesh(b, 6, add_material(b, diffuse_material(0.5, 0.5, 0.5)))},
                 {"translation", {0, 0, -2}}});
    add_lamp(b, sized ? 0.15 : 0, 10, {0.3, 0.2, 1.7});
    const TestCamera camera{.eye = {0, 0, -1.2}, .target = {0, 0, -2}, .yfov_deg = 60, .width = 8, .height = 8};
    m[sized] = mean_of(traced(*dark_world(b, camera), path_settings(3), camera, sized ? 16384 : 256));
  }
  RecordProperty("means", fmt::format("{} {}, {} {}", m[0].mean, m[0].error, m[1].mean, m[1].error));
  EXPECT_NEAR(m[0].mean, m[1].mean, 4 * std::hypot(m[0].error, m[1].error) + 0.01 * m[1].mean);
  EXPECT_LT(m[0].error, 0.02 * m[0].mean);
  EXPECT_LT(m[1].error, 0.02 * m[1].mean);
}

// A prism turns the sun's light downwards by total reflection: none comes straight, each wall takes its 4 %.
TEST(RefractedLamps, ThePrismTurnsTheSun) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", add_prism_mesh(b, add_material(b, glass_material(1.5, 0, 1)))}});
  add_node(b, {{"mesh", add_square_mesh(b, 3, add_material(b, diffuse_material(0.5, 0.5, 0.5)))},
               {"translation", {0, 0, -2}}});
  // Along -X.
  add_light(b, {{"type", "directional"}, {"intensity", 7}}, {{"rotation", {0, std::sqrt(0.5), 0, std::sqrt(0.5)}}});
  use_all(b);
  const TestCamera camera{.eye = {0, 0, -1.1}, .target = {0, 0, -2}, .yfov_deg = 60, .width = 8, .height = 8};
  const MeanError m = mean_of(traced(*dark_world(b, camera), path_settings(4), camera, 128));
  EXPECT_NEAR(m.mean, 0.5 / pi * 7 * 0.96 * 0.96, 5 * m.error + 1e-4);
  EXPECT_LT(m.error, 0.03 * m.mean);
}

// Rough glass needs none of it: its facets have a density.
TEST(RefractedLamps, RoughGlassShowsLampsByItsFacets) {
  MeanError m[2];
  for (const bool sized : {false, true}) {
    GltfBuilder b = empty_scene();
    add_slab(b, 10, 0.3, add_material(b, glass_material(1.5, 0.3, 1)));
    add_node(b, {{"mesh", add_square_mesh(b, 6, add_material(b, diffuse_material(0.5, 0.5, 0.5)))},
                 {"translation", {0, 0, -1}}});
    add_lamp(b, sized ? 0.1 : 0, 10, {0, 0, 1});
    const TestCamera camera{.eye = {0, 0, -0.4}, .target = {0, 0, -1}, .yfov_deg = 90, .width = 8, .height = 8};
    const auto t = dark_world(b, camera);
    EXPECT_FALSE(t->world->bends_lamps());
    m[sized] = mean_of(traced(*t, path_settings(3), camera, 4096));
  }
  EXPECT_GT(m[0].mean, 0.1);
  EXPECT_NEAR(m[0].mean, m[1].mean, 5 * std::hypot(m[0].error, m[1].error) + 0.01 * m[1].mean);
}

// Where lamps and glass are of an extreme kind nothing is lost but light.
TEST(RefractedLamps, ExtremesAreFinite) {
  for (const double ior : {1.0, 1.0001, 3.0, 1e6})
    for (const glm::dvec3 lamp :
         {glm::dvec3(0, 0, 1.0), glm::dvec3(0, 0, 1.0001), glm::dvec3(0, 0, 1e6), glm::dvec3(0)}) {
      GltfBuilder b = empty_scene();
      add_node(b, {{"mesh", add_sphere_mesh(b, 1, add_material(b, glass_material(ior, 0, 1)), 8)}});
      add_node(b, {{"mesh", add_square_mesh(b, 6, add_material(b, diffuse_material(0.5, 0.5, 0.5)))},
                   {"translation", {0, 0, -1.5}}});
      add_lamp(b, 0, 10, lamp);
      const TestCamera camera{.eye = {0, 0, -1.2}, .target = {0, 0, -2}, .yfov_deg = 90, .width = 4, .height = 4};
      const Film film = traced(*dark_world(b, camera), path_settings(6), camera, 8);
      for (size_t i = 0; i < film.pixels(); ++i)
        for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(film.mean(i)[c]) && film.mean(i)[c] >= 0) << ior;
    }
}

}  // namespace candela::reference::test
