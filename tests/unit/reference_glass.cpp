// Paths through glass: pictures whose radiance is known.
#include <numbers>

#include "reference_fixture.h"

namespace candela::reference::test::reference_glass {
namespace {

using std::numbers::pi;

std::unique_ptr<TestWorld> glass_world(GltfBuilder& b, const TestCamera& camera, Sky sky = {}, bool sky_visible = false,
                                       glm::dvec4 background = glm::dvec4(0)) {
  use_all(b);
  return make_world(b, camera, std::move(sky), sky_visible, background, true);
}

double reflectance(double cosine, double n) {
  const double behind = std::sqrt(1 - (1 - cosine * cosine) / (n * n));
  const double s = (cosine - n * behind) / (cosine + n * behind), p = (n * cosine - behind) / (n * cosine + behind);
  return (s * s + p * p) / 2;
}

}  // namespace

// Of what meets a slab r + r (1-r)^2 a^2 / (1 - r^2 a^2) comes back, where r is reflected at each face and a is left
// after each way through: the series of all reflections within. Without absorption: 2r / (1+r). Light stands above the
// slab only.
TEST(Glass, TheFresnelSlab) {
  for (const double degrees : {5.0, 45.0, 70.0})
    for (const bool absorbs : {false, true}) {
      GltfBuilder b = empty_scene();
      const double n = 1.5, thickness = 0.5, left_per_m = 0.6;
      Json material = glass_material(n, 0, 1);
      if (absorbs) material = absorbing(material, 1, glm::dvec3(left_per_m));
      // As add_slab, but turned to the sky.
      const int mesh = add_square_mesh(b, 200, add_material(b, material));
      const double half_right = std::sqrt(0.5);
      add_node(b, {{"mesh", mesh}, {"rotation", {-half_right, 0, 0, half_right}}});
      add_node(b, {{"mesh", mesh}, {"rotation", {half_right, 0, 0, half_right}}, {"translation", {0, -thickness, 0}}});
      const double t = degrees * pi / 180;
      const TestCamera camera{.eye = {4 * std::sin(t), 4 * std::cos(t), 0}, .yfov_deg = 0.01, .width = 8, .height = 8};
      const double c = std::cos(degrees * pi / 180), inside = std::sqrt(1 - (1 - c * c) / (n * n)),
                   r = reflectance(c, n);
      const double a = absorbs ? std::pow(left_per_m, thickness / inside) : 1;
      const double back = r + r * (1 - r) * (1 - r) * a * a / (1 - r * r * a * a),
                   through = (1 - r) * (1 - r) * a / (1 - r * r * a * a);
      if (!absorbs) {
        EXPECT_NEAR(back, 2 * r / (1 + r), 1e-12);
        EXPECT_NEAR(back + through, 1, 1e-12);
      }
      const MeanError lit_above =
          mean_of(traced(*glass_world(b, camera, upper_half(), true), path_settings(), camera, 2048));
      EXPECT_NEAR(lit_above.mean, back, 5 * lit_above.error) << degrees << absorbs;
      EXPECT_LT(lit_above.error, 2e-3);
      // All around: both.
      const MeanError lit =
          mean_of(traced(*glass_world(b, camera, Sky::constant(glm::dvec3(1)), true), path_settings(), camera, 1024));
      EXPECT_NEAR(lit.mean, back + through, 5 * lit.error + 1e-9) << degrees << absorbs;
    }
}

// Nothing is lost or won in clear glass, smooth: the sphere cannot be seen in a uniform sky, pixel by pixel.
TEST(Glass, TheWhiteFurnaceHidesASmoothSphere) {
  for (const double dispersion : {0.0, 5.0}) {
    GltfBuilder b = empty_scene();
    Json material = glass_material(1.5, 0, 1);
    if (dispersion > 0) material["extensions"]["KHR_materials_dispersion"] = {{"dispersion", dispersion}};
    add_node(b, {{"mesh", add_sphere_mesh(b, 1, add_material(b, material), 24)}});
    const TestCamera camera{.eye = {0, 0, 2.2}, .width = 12, .height = 12};
    const Film film = traced(*glass_world(b, camera, Sky::constant(glm::dvec3(1)), true), path_settings(), camera, 512);
    for (int c = 0; c < 3; ++c) {
      const MeanError m = mean_of(film, c);
      EXPECT_NEAR(m.mean, 1, 5 * m.error + 1e-9) << dispersion << c;
      EXPECT_LT(m.error, dispersion > 0 ? 1e-2 : 1e-3);
    }
  }
}

// Rough glass loses what bounces between facets, here at two surfaces and more: 1 to 4 % at roughness 0.3.
TEST(Glass, TheFurnaceOfRoughGlass) {
  for (const double thickness : {0.0, 1.0}) {
    GltfBuilder b = empty_scene();
    add_node(b, {{"mesh", add_sphere_mesh(b, 1, add_material(b, glass_material(1.5, 0.3, thickness)), 48)}});
    const TestCamera camera{.eye = {0, 0, 6}, .yfov_deg = 10, .width = 8, .height = 8};
    const MeanError m =
        mean_of(traced(*glass_world(b, camera, Sky::constant(glm::dvec3(1)), true), path_settings(), camera, 512));
    EXPECT_LT(m.mean, 1 + 5 * m.error);
    EXPECT_GT(m.mean, 0.95 - 5 * m.error) << thickness;
  }
}

// A body of the index of air is seen by its absorption alone: exactly the attenuation colour after the attenuation
// distance.
TEST(Glass, AbsorptionOverAKnownDistance) {
  GltfBuilder b = empty_scene();
  const glm::dvec3 color(0.5, 0.25, 1);
  add_slab(b, 20, 0.75, add_material(b, absorbing(glass_material(1, 0.4, 1), 0.75, color)));
  add_node(b, {{"mesh", add_square_mesh(b, 20, add_material(b, unlit_material(0.25, 0.5, 1)))},
               {"translation", {0, 0, -2}}});
  const TestCamera camera{.eye = {0, 0, 3}, .yfov_deg = 60, .width = 9, .height = 9};
  const auto t = glass_world(b, camera);
  TraceSettings settings = path_settings();
  settings.sampler = centred().sampler;
  const Film film = traced(*t, settings, camera, 1);
  for (size_t i = 0; i < film.pixels(); ++i) {
    const glm::dvec3 at = seen_on_plane(camera, i);
    const double way = glm::length(glm::dvec3(at.x, at.y, 3)) / 3;
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(film.mean(i)[c], std::pow(color[c], way) * (c == 0 ? 0.25 : c == 1 ? 0.5 : 1), 2e-6) << i;
    EXPECT_EQ(film.mean(i).w, 1);
  }
}

// Lamps shine through what does not bend their light: a tinted sheet, by its Fresnel share, and an absorbing body. A
// refracting slab throws a shadow for lamps without size, whose light no path can meet.
TEST(Glass, LampsShineThroughWhatDoesNotBend) {
  const glm::dvec3 tint(0.9, 0.5, 0.2);
  struct Case {
    Json material;
    glm::dvec3 through;
  };
  const double c = 0.8, r = reflectance(c, 1.5), way = 0.5 / c;
  Json half = glass_material(1.5, 0, 0, tint);
  half["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 0.5;
  for (const Case& test : {Case{glass_material(1.5, 0, 0, tint), (1 - r) * (1 - r) * tint * tint},
                           Case{half, 0.25 * (1 - r) * (1 - r) * tint * tint},
                           Case{absorbing(glass_material(1, 0, 1), 0.5, tint), glm::pow(tint, glm::dvec3(way / 0.5))},
                           Case{glass_material(1.5, 0, 1), glm::dvec3(0)}}) {
    GltfBuilder b = empty_scene();
    add_node(
        b, {{"mesh", add_square_mesh(b, 4, add_material(b, diffuse_material(1, 1, 1)))}, {"translation", {0, 0, -2}}});
    add_slab(b, 1, 0.5, add_material(b, test.material));  // a sheet is met twice
    add_light(b, {{"type", "point"}, {"intensity", 10.0}}, {{"translation", {0.9, 0, 0.5}}});
    // Seen past the slab, at the foot of a ray of slope 3/4 through the slab's middle; the light's distance there
    // is 2.5 / c.
    const glm::dvec3 foot(0.9 - 2.5 * 0.75, 0, -2);
    const TestCamera camera{
        .eye = foot + glm::dvec3(-3, 0, 0.5), .target = foot, .yfov_deg = 1e-3, .width = 2, .height = 2};
    const Film film = traced(*glass_world(b, camera), path_settings(1), camera, 4);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(film.mean(0)[k], 10 / (2.5 / c * 2.5 / c) * c / pi * test.through[k], 2e-4 * test.through[k]) << k;
  }
}

// Each way of meeting a light has the same mean behind a sheet, smooth or rough, and around a ball of glass.
TEST(Glass, StrategiesAgree) {
  for (const auto& [roughness, thickness] : {std::pair(0.0, 0.0), {0.4, 0.0}, {0.4, 1.0}, {0.0, 1.0}}) {
    GltfBuilder b = empty_scene();
    add_node(b, {{"mesh", add_square_mesh(b, 3, add_material(b, diffuse_material(0.7, 0.7, 0.7)))}});
    Json lamp = emitting(diffuse_material(0, 0, 0), 6);
    lamp["doubleSided"] = true;
    add_node(b, {{"mesh", add_square_mesh(b, 0.8, add_material(b, lamp))}, {"translation", {0, 0, 2.2}}});
    Json glass = glass_material(1.5, roughness, thickness, {0.9, 0.9, 0.9});
    glass["doubleSided"] = true;
    const int material = add_material(b, glass);
    const int mesh = thickness > 0 ? add_sphere_mesh(b, 0.5f, material, 12) : add_square_mesh(b, 1.2, material);
    add_node(b, {{"mesh", mesh}, {"translation", {0, 0, 1}}});
    const TestCamera camera{.eye = {0, -4, 1.6}, .target = {0, 0, 0.4}, .yfov_deg = 40, .width = 12, .height = 12};
    const auto t = glass_world(b, camera, Sky::constant(glm::dvec3(0.3)), true);
    std::map<Strategy, MeanError> means;
    for (const Strategy strategy : {Strategy::both, Strategy::light, Strategy::brdf}) {
      TraceSettings settings = path_settings();
      settings.strategy = strategy;
      means[strategy] = mean_of(traced(*t, settings, camera, 512), 1);
    }
    const MeanError& both = means[Strategy::both];
    EXPECT_LT(both.error, 0.02 * both.mean);
    for (const Strategy strategy : {Strategy::light, Strategy::brdf})
      EXPECT_NEAR(means[strategy].mean, both.mean, 4 * (means[strategy].error + both.error))
          << roughness << " " << thickness << int(strategy);
  }
}

// Radiance within a medium is as many times that outside as the square of its index; the walls of a body are seen from
// within although they have but one side.
TEST(Glass, ACameraWithinGlassSeesTheSquareOfTheIndex) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", add_sphere_mesh(b, 2, add_material(b, glass_material(1.5, 0, 1)), 24)}});
  const TestCamera camera{.eye = {0, 0, 0.1}, .width = 8, .height = 8};
  const MeanError m =
      mean_of(traced(*glass_world(b, camera, Sky::constant(glm::dvec3(1)), true), path_settings(), camera, 256));
  EXPECT_NEAR(m.mean, 2.25, 5 * m.error + 1e-6);
}

// A body in a body of the same glass has no surface, and what surrounds a body counts: glass in a medium of its index
// is not seen.
TEST(Glass, BodiesOfOneIndexJoin) {
  for (const bool same_material : {true, false}) {
    GltfBuilder b = empty_scene();
    const int outer = add_material(b, absorbing(glass_material(1, 0, 1), 1, {0.5, 0.5, 0.5}));
    const int inner =
        same_material ? outer : add_material(b, absorbing(glass_material(1, 0.5, 1), 1, {0.25, 0.25, 0.25}));
    add_slab(b, 20, 3, outer);
    add_node(b, {{"mesh", add_square_mesh(b, 20, inner)}, {"translation", {0, 0, -1}}});
    add_node(b, {{"mesh", add_square_mesh(b, 20, inner)}, {"translation", {0, 0, -2}}, {"rotation", {1, 0, 0, 0}}});
    add_node(b,
             {{"mesh", add_square_mesh(b, 40, add_material(b, unlit_material(1, 1, 1)))}, {"translation", {0, 0, -4}}});
    const TestCamera camera{.eye = {0, 0, 4}, .yfov_deg = 0.01, .width = 2, .height = 2};
    const Film film = traced(*glass_world(b, camera), path_settings(), camera, 4);
    EXPECT_NEAR(film.mean(0).x, same_material ? 0.125 : 0.5 * 0.5 * 0.25, 1e-6);
  }
}

// Direct light is what techniques approximate: they draw such surfaces opaque, and so does it.
TEST(Glass, DirectTakesGlassAsOpaque) {
  const TestCamera camera{.eye = {0, 0, 2.2}, .width = 8, .height = 8};
  std::vector<Film> films;
  for (const bool clear : {true, false}) {
    GltfBuilder b = empty_scene();
    Json material = glass_material(1.5, 0.4, 1, {0.8, 0.4, 0.2});
    if (!clear)
      material["extensions"].erase("KHR_materials_transmission"), material["extensions"].erase("KHR_materials_volume");
    add_node(b, {{"mesh", add_sphere_mesh(b, 1, add_material(b, material), 12)}});
    use_all(b);
    films.push_back(traced(*make_world(b, camera, Sky::constant(glm::dvec3(1)), true), TraceSettings{}, camera, 8));
  }
  for (size_t i = 0; i < films[0].pixels(); ++i) EXPECT_EQ(films[0].mean(i), films[1].mean(i)) << i;
}

TEST(Glass, ExtremesAreFinite) {
  for (const double ior : {0.0, 1.0, 1.0000002, 1e9, 3e38})
    for (const double roughness : {0.0, 1.0})
      for (const double distance : {1e-38, 1e38}) {
        GltfBuilder b = empty_scene();
        Json material = absorbing(glass_material(ior, roughness, 1, {1, 1, 0}), distance, {1, 0.5, 0});
        material["extensions"]["KHR_materials_dispersion"] = {{"dispersion", 1e6}};
        const int glass = add_material(b, material);
        for (int i = 1; i <= 12; ++i) add_node(b, {{"mesh", add_sphere_mesh(b, float(i) * 0.1f, glass, 6)}});
        for (const double eye : {3.0, 0.25, 1.2}) {
          const TestCamera camera{.eye = {0, 0, eye}, .width = 4, .height = 4};
          const Film film =
              traced(*glass_world(b, camera, Sky::constant(glm::dvec3(1)), true), path_settings(), camera, 8);
          for (size_t i = 0; i < film.pixels(); ++i)
            for (int c = 0; c < 4; ++c)
              EXPECT_TRUE(std::isfinite(film.mean(i)[c])) << ior << " " << roughness << " " << distance << " " << eye;
        }
      }
}

}  // namespace candela::reference::test::reference_glass
