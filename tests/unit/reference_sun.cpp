// Directional lights with a disc.
#include <numbers>

#include "reference_fixture.h"

namespace candela::reference::test::reference_sun {
namespace {

using std::numbers::pi;
constexpr double lux = 3;

GltfBuilder floor_under_the_sun(double tilt_rad = 0) {
  GltfBuilder b = empty_scene();
  use_all(b);
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, diffuse_material(1, 0.5, 0.25)))}});
  add_light(b, {{"type", "directional"}, {"intensity", lux}},
            {{"rotation", {0, std::sin(tilt_rad / 2), 0, std::cos(tilt_rad / 2)}}});
  return b;
}
std::unique_ptr<TestWorld> world_with(const GltfBuilder& b, const TestCamera& camera, double radius_rad, Sky sky = {}) {
  return make_world(b, camera, std::move(sky), false, glm::dvec4(0), false, {}, radius_rad);
}

// The fraction of a disc of one radiance and radius r straight above that lights a horizontal surface past an edge: the
// area of directions' (x, y) with x / z below tan(angle), over that of all. On the unit sphere the edge is half an
// ellipse.
double open_share(double r, double angle) {
  double area = 0;
  constexpr int rows = 2000;
  const double radius = std::sin(r);
  for (int i = 0; i < rows; ++i) {
    const double y = radius * (2 * (i + 0.5) / rows - 1), chord = std::sqrt(radius * radius - y * y);
    area += chord + std::clamp(std::sin(angle) * std::sqrt(1 - y * y), -chord, chord);
  }
  return area * (2 * radius / rows) / (pi * radius * radius);
}

}  // namespace

// A wall's edge above a floor: full light and full shadow where the whole disc or none of it is seen, a penumbra of
// twice the height times the radius' tangent between them.
TEST(Sun, APenumbraIsAsWideAsTheDiscSays) {
  constexpr double height_m = 2, radius = 10 * pi / 180;
  GltfBuilder b = floor_under_the_sun();
  add_node(b, {{"mesh", add_square_mesh(b, 3, add_material(b, diffuse_material(1, 1, 1)))},
               {"translation", {3, 0, height_m}}});
  const TestCamera camera{.eye = {0, 0, 1}, .target = {0, 0, 0}, .yfov_deg = 10, .width = 64, .height = 8};
  const auto t = world_with(b, camera, radius);
  const double half_width = height_m * std::tan(radius), pixel = 2 * std::tan(5 * pi / 180) / 8;
  for (const Mode mode : {Mode::direct, Mode::path}) {
    TraceSettings settings = mode == Mode::path ? path_settings(1) : TraceSettings{};
    const Film film = traced(*t, settings, camera, 256);
    int dark = 0, full = 0, between = 0;
    for (size_t i = 0; i < size_t(camera.width); ++i) {
      double fraction = 0;
      for (size_t y = 0; y < size_t(camera.height); ++y)
        fraction += film.mean(y * size_t(camera.width) + i).x / (lux / pi) / camera.height;
      const double x = seen_on_plane(camera, i).x;
      if (x < -half_width - pixel) {
        EXPECT_NEAR(fraction, 1, 2e-3) << x;
        ++full;
      } else if (x > half_width + pixel) {
        EXPECT_EQ(fraction, 0) << x;
        ++dark;
      } else {
        EXPECT_NEAR(fraction, open_share(radius, std::atan2(-x, height_m)), 0.01) << x;
        ++between;
      }
    }
    EXPECT_GT(dark, 10);
    EXPECT_GT(full, 10);
    EXPECT_GT(between, 25);
  }
}

// What arrives is the light's illuminance, however large the disc and however low it stands, as long as all of it is
// above the floor.
TEST(Sun, ADiscKeepsTheEnergyOfAPoint) {
  const TestCamera camera{.eye = {0, 0, 4}, .yfov_deg = 20};
  for (const double tilt : {0.0, 0.9})
    for (const double degrees : {0.0, 0.2666, 5.0, 30.0}) {
      const auto t = world_with(floor_under_the_sun(tilt), camera, degrees * pi / 180);
      for (const Mode mode : {Mode::direct, Mode::path}) {
        // A large disc is found in two ways, whose sum is not as even as one is: it takes more samples.
        const int spp = degrees > 10 ? 1024 : 256;
        const Film film = traced(*t, mode == Mode::path ? path_settings(1) : TraceSettings{}, camera, spp);
        const double expected = lux * std::cos(tilt) / pi;
        EXPECT_NEAR(mean_of(film).mean, expected, 3e-4 * expected) << tilt << " " << degrees;
      }
    }
}

// Without a directional light, and with a radius of 0, pictures keep their bytes: the disc takes no number from others.
TEST(Sun, ChangesNothingWhereThereIsNoDisc) {
  GltfBuilder lamp = empty_scene();
  use_all(lamp);
  add_node(lamp, {{"mesh", add_square_mesh(lamp, 1, add_material(lamp, diffuse_material(0.9, 0.5, 0.2)))}});
  add_light(lamp, {{"type", "point"}, {"intensity", 5.0}}, {{"translation", {0.5, 0, 1}}});
  const TestCamera camera;
  const Sky sky = Sky::constant(glm::dvec3(0.5));
  for (const Mode mode : {Mode::direct, Mode::path}) {
    TraceSettings settings;
    settings.mode = mode;
    const Film with = traced(*world_with(lamp, camera, 0.1, sky), settings, camera, 16),
               without = traced(*make_world(lamp, camera, sky), settings, camera, 16);
    for (size_t i = 0; i < with.pixels(); ++i) ASSERT_EQ(with.mean(i), without.mean(i)) << i;
  }
}

}  // namespace candela::reference::test::reference_sun
