// Point and spot lights that are spheres.
#include <numbers>

#include "reference_fixture.h"

namespace candela::reference::test::reference_lamp_size {
namespace {

using std::numbers::pi;

PunctualLight lamp_of(double radius_m, LightType type = LightType::point) {
  PunctualLight light;
  light.type = type;
  light.position = {0, 0, 3};
  light.direction = {0, 0, -1};
  light.intensity = glm::dvec3(5);
  light.range_m = std::numeric_limits<double>::infinity();
  light.cos_inner = std::cos(0.3), light.cos_outer = std::cos(0.6);
  light.radius_m = radius_m;
  return light;
}

Json sized(Json light, double radius_m) {
  light["extensions"]["CANDELA_light_size"]["radius"] = radius_m;
  return light;
}
void add_lamp(GltfBuilder& b, double radius_m, double candela, glm::dvec3 at, Json light = {{"type", "point"}}) {
  light["intensity"] = candela;
  add_light(b, radius_m > 0 ? sized(light, radius_m) : light, {{"translation", {at.x, at.y, at.z}}});
  use_all(b);
  b.json["extensionsUsed"].push_back("CANDELA_light_size");
}

GltfBuilder floor_scene(Json material = diffuse_material(1, 1, 1)) {
  GltfBuilder b = empty_scene();
  use_all(b);
  add_node(b, {{"mesh", add_square_mesh(b, 8, add_material(b, std::move(material)))}});
  return b;
}

// Irradiance, over pi times the radiance, of a sphere that a surface sees under half angle asin(sine), its centre
// cos_theta off the normal (Snyder, "Area Light Sources for Real-Time Graphics", 1996).
double sphere_share(double cos_theta, double sine) {
  const double s2 = sine * sine;
  if (cos_theta >= sine) return cos_theta * s2;
  if (cos_theta <= -sine) return 0;
  const double sin_theta = std::sqrt(1 - cos_theta * cos_theta), x = std::sqrt(1 / s2 - 1);
  const double y = -x * cos_theta / sin_theta, root = sin_theta * std::sqrt(1 - y * y);
  return ((cos_theta * std::acos(y) - x * root) * s2 + std::atan(root / x)) / pi;
}

// The fraction of a sphere's light, as seen from a floor below it, on the open side of a vertical plane's edge that the
// point sees at `edge_angle` off straight up: by even steps over the cap.
double open_share(double sine, glm::dvec2 centre, double edge_angle) {
  double all = 0, open = 0;
  constexpr int rows = 400;
  const double cap = 1 - std::sqrt(1 - sine * sine), tilt = std::atan2(centre.x, centre.y);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j) {
      const double down = cap * (i + 0.5) / rows, phi = 2 * pi * (j + 0.5) / rows,
                   across = std::sqrt(down * (2 - down));
      const double x = across * std::cos(phi), y = across * std::sin(phi), z = 1 - down;
      const double along = x * std::cos(tilt) + z * std::sin(tilt), up = z * std::cos(tilt) - x * std::sin(tilt);
      all += up;
      if (std::atan2(along, up) < edge_angle) open += up;
      (void)y;
    }
  return open / all;
}

}  // namespace

// A surface that faces the lamp gets what it gets from the point, at any distance from the sphere's surface on, and the
// two ways to find the lamp say the same of it.
TEST(LampSize, KeepsTheIlluminanceOfThePoint) {
  for (const LightType type : {LightType::point, LightType::spot})
    for (const double radius : {1e-3, 0.1, 0.9, 0.999})
      for (const glm::dvec3 at :
           {glm::dvec3(0, 0, 2), glm::dvec3(0.3, 0.1, 1.5), glm::dvec3(1e3, 2, 3), glm::dvec3(0, 1, -1e4)}) {
        const PunctualLight lamp = lamp_of(radius, type);
        const Arrival point = arriving(lamp_of(0, type), at);
        double facing = 0;
        constexpr int rows = 64;
        for (int i = 0; i < rows; ++i)
          for (int j = 0; j < rows; ++j) {
            const Arrival a = arriving(lamp, at, (glm::dvec2(i, j) + 0.5) / double(rows));
            facing += a.illuminance.x * glm::dot(a.l, point.l) / (rows * rows);
            const auto again = light_in(lamp, at, a.l);
            ASSERT_TRUE(again) << radius;
            EXPECT_EQ(again->illuminance, a.illuminance);
            EXPECT_EQ(again->pdf, a.pdf);
            EXPECT_NEAR(again->distance_m, a.distance_m, 1e-6 * point.distance_m);
            // On the sphere.
            EXPECT_NEAR(glm::distance(at + a.l * a.distance_m, lamp.position), radius, 1e-6 * point.distance_m);
            EXPECT_LE(a.distance_m, point.distance_m);
          }
        EXPECT_NEAR(facing, point.illuminance.x, 1e-4 * point.illuminance.x) << radius;
        EXPECT_FALSE(light_in(lamp, at, -point.l));
        EXPECT_EQ(point.pdf, 0);
      }
}

// At its surface it is as bright as inside, where the light comes from all sides.
TEST(LampSize, IsAsBrightInsideAsAtItsSurface) {
  const PunctualLight lamp = lamp_of(2);
  const Arrival outside = arriving(lamp, {0, 0, 1 - 1e-9}), inside = arriving(lamp, {0, 0, 1 + 1e-9}, {0.7, 0.2}),
                middle = arriving(lamp, {0, 0, 3}, {0.1, 0.9});
  EXPECT_NEAR(outside.illuminance.x * outside.pdf, 5 / (4 * pi), 1e-6);
  EXPECT_NEAR(inside.illuminance.x * inside.pdf, 5 / (4 * pi), 1e-6);
  EXPECT_NEAR(middle.illuminance.x * middle.pdf, 5 / (4 * pi), 1e-12);
  EXPECT_NEAR(middle.distance_m, 2, 1e-12);
  ASSERT_TRUE(light_in(lamp, {0, 0, 1.5}, {0, 0, -1}));
  EXPECT_NEAR(light_in(lamp, {0, 0, 1.5}, {0, 0, -1})->distance_m, 0.5, 1e-12);
  EXPECT_NEAR(light_in(lamp, {0, 0, 1.5}, {0, 0, 1})->distance_m, 3.5, 1e-12);
}

// The floor under a sphere, from straight below to where part of it has set, against the closed form.
TEST(LampSize, LightsAPlaneAsTheClosedFormSays) {
  constexpr double radius = 0.6, candela = 4;
  for (const double height : {1.5, 0.7, 0.3}) {
    GltfBuilder b = floor_scene();
    add_lamp(b, radius, candela, {0, 0, height});
    const TestCamera camera{.eye = {2, 0, 2}, .target = {2, 0, 0}, .yfov_deg = 10, .width = 48, .height = 6};
    const auto t = make_world(b, camera);
    for (const Mode mode : {Mode::direct, Mode::path}) {
      TraceSettings settings = mode == Mode::path ? path_settings(1) : TraceSettings{};
      const Film film = traced(*t, settings, camera, 256);
      double worst = 0;
      for (size_t i = 0; i < film.pixels(); ++i) {
        const glm::dvec3 to = glm::dvec3(0, 0, height) - seen_on_plane(camera, i);
        const double d = glm::length(to);
        ASSERT_GT(d, radius);
        const double expected = candela / (radius * radius * pi) * sphere_share(to.z / d, radius / d);
        EXPECT_NEAR(film.mean(i).x, expected, 0.06 * expected) << i << " " << height;
        worst += film.mean(i).x / expected - 1;
      }
      EXPECT_NEAR(worst / double(film.pixels()), 0, 2e-3) << height;
    }
  }
}

// A straight edge between lamp and floor: the penumbra ends where the tangents to the sphere meet the floor, which are
// similar triangles but for the sphere's curvature, and follows the sphere's part above the edge within.
TEST(LampSize, APenumbraIsAsWideAsTheLampSays) {
  constexpr double radius = 0.4, lamp_m = 3, edge_m = 1, candela = 9;
  GltfBuilder b = floor_scene();
  add_node(b, {{"mesh", add_square_mesh(b, 3, add_material(b, diffuse_material(1, 1, 1)))},
               {"translation", {3, 0, edge_m}}});
  add_lamp(b, radius, candela, {0, 0, lamp_m});
  const TestCamera camera{.eye = {0, 0, 0.9}, .target = {0, 0, 0}, .yfov_deg = 6, .width = 96, .height = 8};
  const auto t = make_world(b, camera);
  const double half_width = edge_m * std::tan(std::asin(radius / (lamp_m - edge_m)));
  EXPECT_NEAR(half_width, radius * edge_m / (lamp_m - edge_m), 0.03 * half_width);
  const double pixel = 0.9 * 2 * std::tan(3 * pi / 180) / 8;
  for (const Mode mode : {Mode::direct, Mode::path}) {
    TraceSettings settings = mode == Mode::path ? path_settings(1) : TraceSettings{};
    settings.sampler.seed = 3;
    Film film(camera.width, camera.height, {.terms = true, .lamp_shadow = true});
    ASSERT_TRUE(
        film.add(Integrator(*t->world, settings, camera.width, camera.height), 256, [](double) { return true; }));
    int dark = 0, full = 0, between = 0;
    for (size_t i = 0; i < size_t(camera.width); ++i) {
      const double x = seen_on_plane(camera, i).x;
      const glm::dvec2 centre(-x, lamp_m);
      const double d = glm::length(centre);
      const double lit = candela * lamp_m / (d * d * d) / pi;
      double fraction = 0, layer = 0;
      for (size_t y = 0; y < size_t(camera.height); ++y) {
        fraction += film.mean(y * size_t(camera.width) + i).x / lit / camera.height;
        layer += film.lamp_shadow(y * size_t(camera.width) + i) / camera.height;
      }
      EXPECT_NEAR(layer, fraction, 0.03);
      if (x < -half_width - pixel) {
        EXPECT_NEAR(fraction, 1, 0.01) << x;
        ++full;
      } else if (x > half_width + pixel) {
        EXPECT_EQ(fraction, 0) << x;
        EXPECT_EQ(layer, 0) << x;
        ++dark;
      } else {
        EXPECT_NEAR(fraction, open_share(radius / d, centre, std::atan2(-x, edge_m)), 0.02) << x;
        ++between;
      }
    }
    EXPECT_GT(dark, 10);
    EXPECT_GT(full, 10);
    EXPECT_GT(between, 25);
  }
}

TEST(LampSize, TendsToThePoint) {
  GltfBuilder b[2] = {floor_scene(), floor_scene()};
  for (int k = 0; k < 2; ++k) {
    add_lamp(b[k], k * 1e-4, 4, {0.2, 0.1, 1});
    add_lamp(b[k], k * 1e-4, 20, {-1, 0.5, 2}, {{"type", "spot"}, {"spot", {{"outerConeAngle", 0.6}}}, {"range", 9}});
  }
  const TestCamera camera;
  const auto point = make_world(b[0], camera), sphere = make_world(b[1], camera);
  for (const Mode mode : {Mode::direct, Mode::path}) {
    const Film a = traced(*point, centred(mode), camera, 1), c = traced(*sphere, centred(mode), camera, 1);
    for (size_t i = 0; i < a.pixels(); ++i) EXPECT_NEAR(c.mean(i).x, a.mean(i).x, 2e-3 * a.mean(i).x + 1e-9);
  }
}

// Inside the sphere a surface gets pi times its radiance from whichever side it looks.
TEST(LampSize, LightsWhatIsInsideFromAllSides) {
  for (const double radius : {20.0, 1e4}) {
    GltfBuilder b = floor_scene();
    add_lamp(b, radius, radius * radius, {0.4, 0.2, -0.5});
    const TestCamera camera{.yfov_deg = 20};
    const auto t = make_world(b, camera);
    for (const Mode mode : {Mode::direct, Mode::path}) {
      const MeanError m = mean_of(traced(*t, mode == Mode::path ? path_settings(1) : TraceSettings{}, camera, 256));
      EXPECT_NEAR(m.mean, 1 / pi, 2e-3) << radius;
    }
  }
}

// By the lamp's directions, the BRDF's and both: one mean, however smooth the surface, through blended sheets and fog,
// after bounces and with a sun of a size beside.
TEST(LampSize, EveryStrategyHasOneMean) {
  for (const double roughness : {0.3, 0.7})
    for (const bool foggy : {false, true}) {
      GltfBuilder b = empty_scene();
      use_all(b);
      Json walls = {{"pbrMetallicRoughness", base_color(0.6, 0.5, 0.4)}};
      walls["pbrMetallicRoughness"]["roughnessFactor"] = roughness;
      Json sheet = {
          {"pbrMetallicRoughness", base_color(0.3, 0.3, 0.3, 0.4)}, {"alphaMode", "BLEND"}, {"doubleSided", true}};
      add_node(b, {{"mesh", add_square_mesh(b, 3, add_material(b, walls))}});
      add_node(b, {{"mesh", add_square_mesh(b, 3, 0)},
                   {"translation", {-2, 0, 1}},
                   {"rotation", {0, 0.70710678, 0, 0.70710678}}});
      add_node(b, {{"mesh", add_square_mesh(b, 0.6f, add_material(b, sheet))}, {"translation", {0.3, 0, 0.5}}});
      add_lamp(b, 0.4, 2, {0.2, 0.3, 1.2});
      add_lamp(b, 0.3, 6, {-1.2, -0.4, 0.8}, {{"type", "spot"}, {"spot", {{"outerConeAngle", 0.9}}}});
      add_light(b, {{"type", "directional"}, {"intensity", 0.5}}, {{"rotation", {0, 0.3, 0, 0.954}}});
      use_all(b);
      b.json["extensionsUsed"].push_back("CANDELA_light_size");
      const TestCamera camera{.eye = {0.5, 0, 4}, .yfov_deg = 40};
      std::optional<Fog> fog;
      if (foggy) {
        fog.emplace();
        fog->extinction_per_m = glm::dvec3(0.2), fog->scattering_per_m = glm::dvec3(0.15), fog->anisotropy = 0.5;
        fog->lowest = glm::dvec3(-4), fog->highest = glm::dvec3(4);
      }
      const auto t = make_world(b, camera, {}, false, glm::dvec4(0), false, fog, 0.2);
      MeanError m[3];
      for (const Strategy strategy : {Strategy::both, Strategy::light, Strategy::brdf}) {
        TraceSettings settings = path_settings(3);
        settings.strategy = strategy;
        settings.sampler.seed = 11 + uint64_t(strategy);
        m[int(strategy)] = mean_of(traced(*t, settings, camera, 1024));
      }
      for (int k : {1, 2})
        EXPECT_NEAR(m[k].mean, m[0].mean, 5 * std::hypot(m[k].error, m[0].error))
            << roughness << " " << foggy << " " << k;
      EXPECT_GT(m[0].mean, 0.02);
      EXPECT_LT(m[0].error, 0.01 * m[0].mean);
      if (foggy) continue;
      // direct sees the first bounce: the same two ways of it.
      MeanError d[3];
      for (const Strategy strategy : {Strategy::both, Strategy::light, Strategy::brdf}) {
        TraceSettings settings;
        settings.strategy = strategy;
        d[int(strategy)] = mean_of(traced(*t, settings, camera, 1024));
      }
      for (int k : {1, 2}) EXPECT_NEAR(d[k].mean, d[0].mean, 5 * std::hypot(d[k].error, d[0].error)) << roughness << k;
      const MeanError once = mean_of(traced(*t, path_settings(1), camera, 1024));
      EXPECT_NEAR(once.mean, d[0].mean, 5 * std::hypot(once.error, d[0].error)) << roughness;
    }
}

// A near mirror shows the sphere: where the mirrored ray meets it, at its radiance.
TEST(LampSize, ANearMirrorShowsTheSphere) {
  constexpr double radius = 0.5, candela = 1;
  GltfBuilder b = empty_scene();
  use_all(b);
  Json metal = {
      {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 1}}, {"metallicFactor", 1}, {"roughnessFactor", 0.05}}}};
  add_node(b, {{"mesh", add_square_mesh(b, 8, add_material(b, metal))}});
  add_lamp(b, radius, candela, {0, 0, 6});
  const TestCamera camera{.eye = {0, 0, 4}, .yfov_deg = 24, .width = 24, .height = 24};
  const auto t = make_world(b, camera);
  const double bright = candela / (pi * radius * radius);
  for (const Mode mode : {Mode::direct, Mode::path}) {
    const Film film = traced(*t, mode == Mode::path ? path_settings(1) : TraceSettings{}, camera, 64);
    int inside = 0, outside = 0;
    for (size_t i = 0; i < film.pixels(); ++i) {
      const glm::dvec3 p = seen_on_plane(camera, i), l = glm::normalize(glm::dvec3(p.x, p.y, 4)),
                       to = glm::dvec3(0, 0, 6) - p;
      const double aside = glm::length(to - glm::dot(to, l) * l);
      if (aside < radius - 0.15) {
        EXPECT_NEAR(film.mean(i).x, bright, 0.05 * bright) << i;
        ++inside;
      } else if (aside > radius + 0.3) {
        EXPECT_LT(film.mean(i).x, 0.1 * bright) << i;
        ++outside;
      }
    }
    EXPECT_GT(inside, 3);
    EXPECT_GT(outside, 100);
  }
}

// Sizes from a grain to a world, the camera and surfaces inside and outside, a lamp through a wall: always numbers.
TEST(LampSize, IsANumberWhateverTheSize) {
  for (const double radius : {1e-30, 1e-3, 0.5, 1e4, 1e30}) {
    GltfBuilder b = floor_scene({{"pbrMetallicRoughness", {{"metallicFactor", 1}, {"roughnessFactor", 0}}}});
    add_lamp(b, radius, 1e3, {0.1, 0.1, 0.01});
    add_lamp(b, radius, 1e3, {1, 0, 0}, {{"type", "spot"}, {"spot", Json::object()}, {"range", 3}});
    Fog fog;
    fog.extinction_per_m = glm::dvec3(0.1), fog.scattering_per_m = glm::dvec3(0.1);
    const TestCamera camera;
    const auto t = make_world(b, camera, {}, false, glm::dvec4(0), false, fog);
    for (const Mode mode : {Mode::direct, Mode::path}) {
      TraceSettings settings;
      settings.mode = mode, settings.fog_steps = 4;
      const Film film = traced(*t, settings, camera, 16, true);
      for (size_t i = 0; i < film.pixels(); ++i) {
        ASSERT_TRUE(std::isfinite(film.mean(i).x) && film.mean(i).x >= 0) << radius << " " << i;
        ASSERT_TRUE(std::isfinite(film.variance(i).x)) << radius;
      }
    }
  }
}

}  // namespace candela::reference::test::reference_lamp_size
