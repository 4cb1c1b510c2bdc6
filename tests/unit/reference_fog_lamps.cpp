// Many lamps in fog: points of a ray that all of them share (lamps_along_ray.h), against the sum over every lamp and
// against closed forms.
#include <numbers>

#include "reference/lamps_along_ray.h"
#include "reference_fixture.h"

namespace candela::reference::test::reference_fog_lamps {
namespace {

using std::numbers::pi;
const TestCamera camera{.eye = {0, 1.5, 9}, .target = {0, 1, 0}, .yfov_deg = 50, .width = 8, .height = 6};

double number(uint32_t i) {
  i = (i ^ 61) ^ (i >> 16), i *= 9, i ^= i >> 4, i *= 0x27d4eb2d, i ^= i >> 15;
  return double(i) / 4294967296.0;
}
glm::dvec3 place_of(int i) {
  const uint32_t k = uint32_t(i) * 3;
  return {20 * number(k) - 10, 4 * number(k + 1), 20 * number(k + 2) - 14};
}
// Points without an end, points with one, and spots that shine down or aside.
void add_field(GltfBuilder& b, int count, bool plain = false) {
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 at = place_of(i);
    const double strength = 0.5 + 8 * std::pow(number(uint32_t(i) + 9000), 4);
    Json light = {{"type", "point"}, {"intensity", strength}, {"color", {1, 0.3 + 0.1 * (i % 7), 0.2 + 0.2 * (i % 4)}}};
    Json node = {{"translation", {at.x, at.y, at.z}}};
    if (plain) {
      light["color"] = {1, 1, 1};
    } else if (i % 3 == 1) {
      light["range"] = 2 + 4 * number(uint32_t(i) + 5000);
    } else if (i % 3 == 2) {
      light["type"] = "spot";
      light["spot"] = {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4 + 0.2 * (i % 5)}};
      if (i % 2 == 0) light["range"] = 7;
      node["rotation"] = i % 4 == 0 ? Json{0.3, 0.4, 0, 0.8660254} : Json{-0.70710678, 0, 0, 0.70710678};
    }
    if (!plain && i % 8 == 5) light["extensions"]["CANDELA_light_size"]["radius"] = 0.1;
    add_light(b, light, node);
  }
  use_all(b);
  b.json["extensionsUsed"].push_back("CANDELA_light_size");
}
Fog air(double extinction) {
  Fog fog;
  fog.extinction_per_m = glm::dvec3(extinction), fog.scattering_per_m = glm::dvec3(extinction);
  return fog;
}

TraceSettings shared_by(int lights, int steps = 8) {
  TraceSettings s;
  s.fog_lights = lights, s.fog_steps = steps, s.ambient = Ambient::off;
  s.sampler = {SamplerKind::uniform, 1, 0};  // all at the pixel's centre
  return s;
}

}  // namespace

// A wall, a floor, coloured fog that thins out upwards and scatters forwards: whatever the points are, the mean is that
// of all lamps' own.
TEST(FogLamps, PointsThatManyShareHaveTheMeanOfTheSum) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"mesh", add_square_mesh(b, 12, add_material(b, unlit_material(0, 0, 0)))},
               {"rotation", {-0.70710678, 0, 0, 0.70710678}}});
  Json wall = unlit_material(0, 0, 0);
  wall["doubleSided"] = true;
  add_node(b, {{"mesh", add_square_mesh(b, 2, add_material(b, wall))},
               {"translation", {1, 1.5, 1}},
               {"rotation", {0, 0.5, 0, 0.8660254}}});
  add_field(b, 300);
  for (const auto& [extinction, g] : {std::pair(0.03, 0.6), {0.6, -0.3}}) {
    Fog fog;
    fog.extinction_per_m = glm::dvec3(1, 1.4, 2) * extinction,
    fog.scattering_per_m = glm::dvec3(1, 1, 1.5) * extinction;
    fog.anisotropy = g, fog.falloff_per_m = 0.3;
    const auto t = make_world(b, camera, {}, false, glm::dvec4(0), false, fog);
    ASSERT_EQ(t->world->tree_punctual().size(), 300);
    const Film all = traced(*t, shared_by(0), camera, 4);
    for (const int lights : {1, 8, 32}) {
      const int spp = 256 / lights;
      const Film shared = traced(*t, shared_by(lights), camera, spp);
      for (int c = 0; c < 3; ++c) {
        const MeanError truth = mean_of(all, c), m = mean_of(shared, c);
        EXPECT_NEAR(m.mean, truth.mean, 4.5 * (m.error + truth.error)) << lights << " " << c;
        EXPECT_LT(m.error, (lights == 1 ? 0.02 : 0.01) * truth.mean) << lights << " " << c;
      }
      // Not only all pixels together: every one of them, by the sum of squares of their standard errors.
      double chi2 = 0;
      for (size_t i = 0; i < all.pixels(); ++i) {
        const double variance = all.variance(i).y + shared.variance(i).y;
        if (variance > 0) chi2 += std::pow(shared.mean(i).y - all.mean(i).y, 2) / variance;
      }
      EXPECT_LT(chi2 / double(all.pixels()), 1.8) << lights;
    }
  }
}

// Lamps without an end in air too thin to weaken light: each gives a difference of two arc tangents.
TEST(FogLamps, AFieldInThinAirHasTheSumOfItsClosedForms) {
  GltfBuilder b = empty_scene();
  constexpr int count = 400;
  add_field(b, count, true);
  Fog fog = air(1e-9);
  fog.lowest.z = -20, fog.highest.z = 5;
  const auto t = make_world(b, camera, {}, false, glm::dvec4(0), false, fog);
  TraceSettings settings = shared_by(16, 16);
  const Integrator integrator(*t->world, settings, camera.width, camera.height);
  for (const glm::dvec2 pixel : {glm::dvec2(1.5, 1.5), {4.2, 3.1}, {7.3, 5.7}}) {
    const glm::dvec3 d = glm::normalize(t->world->camera_ray(pixel, camera.width, camera.height).direction);
    double expected = 0;
    for (const PunctualLight& light : t->world->punctual_lights()) {
      const glm::dvec3 at = light.position;
      const double nearest = glm::dot(at, d), aside = glm::length(at - nearest * d);
      const double begin = (5 - camera.eye.z) / d.z, end = (-20 - camera.eye.z) / d.z;
      expected += light.intensity.y * 1e-9 / (4 * pi) / aside *
                  (std::atan((end - nearest) / aside) - std::atan((begin - nearest) / aside));
    }
    double sum = 0, squares = 0;
    constexpr int samples = 256;
    for (int i = 0; i < samples; ++i) {
      const double value = integrator.sample_at(pixel, uint64_t(i)).radiance.y / expected;
      sum += value / samples, squares += value * value / samples;
    }
    const double deviation = std::sqrt(std::max(squares - sum * sum, 0.0));
    EXPECT_NEAR(sum, 1, 4.5 * deviation / std::sqrt(samples) + 1e-6) << pixel.x;
    // A point's fraction is so near to its light that 256 of them, for 400 lamps, leave little to chance.
    EXPECT_LT(deviation, 0.02) << pixel.x;
  }
}

// The look's light of lamps in the air has the same points, in both modes.
TEST(FogLamps, VolumetricLightHasTheMeanOfTheSum) {
  GltfBuilder b = empty_scene();
  add_field(b, 200);
  auto t = make_world(b, camera);
  for (const bool by_attenuation : {false, true}) {
    WorldInput input{t->scene, t->pose, t->view, t->frame};
    input.volumetric = Volumetric{.phi = 1, .tau_per_m = 0.05, .anisotropy = 0.4, .by_attenuation = by_attenuation};
    t->world = std::make_unique<World>(input, t->warnings);
    const Film all = traced(*t, shared_by(0), camera, 4);
    for (const Mode mode : {Mode::direct, Mode::path}) {
      TraceSettings settings = shared_by(8);
      settings.mode = mode;
      const Film shared = traced(*t, settings, camera, 64);
      for (int c = 0; c < 3; ++c) {
        const MeanError truth = mean_of(all, c), m = mean_of(shared, c);
        EXPECT_GT(truth.mean, 0.01);
        EXPECT_NEAR(m.mean, truth.mean, 4.5 * (m.error + truth.error)) << int(mode) << " " << c;
        EXPECT_LT(m.error, 0.01 * truth.mean) << int(mode) << " " << c;
      }
    }
  }
}

TEST(FogLamps, ALampHasAsManyPointsAsItSays) {
  GltfBuilder b = empty_scene();
  add_field(b, 150);
  const auto t = make_world(b, camera, {}, false, glm::dvec4(0), false, air(0.1));
  const World& world = *t->world;
  std::vector<LampsAlongRay::Point> chosen;
  std::vector<uint32_t> reaching;
  for (int k = 0; k < 6; ++k) {
    const glm::dvec3 origin(number(uint32_t(k)) - 0.5, 0, 0),
        direction =
            glm::normalize(glm::dvec3(number(uint32_t(k) + 50) - 0.5, 0.4 * number(uint32_t(k) + 70) - 0.3, -1));
    const Span span{k % 2 ? 2.0 : 0.0, k == 5 ? endless : 14.0};
    const LampsAlongRay lamps(world, origin, direction, span, 0,
                              [](double at_m, glm::dvec3, glm::dvec3, double distance_m) {
                                return glm::dvec3(std::exp(-0.1 * (at_m + distance_m)));
                              });
    ASSERT_TRUE(lamps.reaching(1000, reaching));
    ASSERT_GT(reaching.size(), 40);
    EXPECT_LT(reaching.size(), 150) << "some lie out of their range";
    std::vector<uint32_t> few;
    EXPECT_FALSE(lamps.reaching(reaching.size() - 1, few));
    std::vector<bool> reaches(world.punctual_lights().size());
    for (size_t i = 0; i < world.punctual_lights().size(); ++i) {
      reaches[i] = !lit_part(world.punctual_lights()[i], origin, direction, span).empty();
      EXPECT_EQ(reaches[i], std::ranges::binary_search(reaching, uint32_t(i))) << i;
    }
    for (const int points : {5, 40}) {
      std::vector<double> counted(reaches.size()), expected(reaches.size()), even(reaches.size());
      constexpr int offsets = 1024;
      for (int i = 0; i < offsets; ++i) {
        lamps.choose(points, (i + 0.5) / offsets, chosen);
        // A cluster may seem to reach the ray where none of its lamps does.
        ASSERT_LE(chosen.size(), size_t(points));
        for (const LampsAlongRay::Point& p : chosen) {
          ASSERT_TRUE(reaches[p.light]);
          ASSERT_TRUE(p.u >= 0 && p.u < 1) << p.u;
          if (expected[p.light] > 0) {
            ASSERT_EQ(p.expected, expected[p.light]) << "the same whatever the offset is";
          }
          expected[p.light] = p.expected;
          counted[p.light] += 1.0 / offsets, even[p.light] += p.u / offsets;
        }
      }
      double all = 0;
      for (size_t i = 0; i < reaches.size(); ++i) {
        EXPECT_NEAR(counted[i], expected[i], 2.0 / offsets + 1e-9) << i;
        EXPECT_NEAR(even[i], 0.5 * expected[i], 2.0 / offsets) << i;
        all += expected[i];
      }
      EXPECT_LE(all, points * (1 + 1e-9));
      EXPECT_GT(all, 0.8 * points);
    }
  }
}

// Lamps in one place, on the ray, at the eye, far away, faint and strong, in air that is nearly nothing or as good as a
// wall, with and without an end: every sample is finite, and the mean is the sum's.
TEST(FogLamps, ExtremesKeepTheMean) {
  GltfBuilder b = empty_scene();
  for (int i = 0; i < 60; ++i) {
    glm::dvec3 at(0.3, 1.2, 2);
    if (i % 5 == 1) at = {0, 1.5 - 0.5 * i / 90.0, 9 - 0.1 * i};  // about the ray of the picture's middle
    if (i % 5 == 2) at = camera.eye;
    if (i % 5 == 3) at = glm::dvec3(1e5, 3e4, -2e5) * (i / 60.0);
    if (i % 5 == 4) at = place_of(i);
    const double strength = i % 5 == 3 ? 1e12 : i % 7 == 0 ? 1e-12 : 1.0;
    add_light(b, {{"type", "point"}, {"intensity", strength}}, {{"translation", {at.x, at.y, at.z}}});
  }
  use_all(b);
  for (const double extinction : {1e-9, 0.1, 1e6})
    for (const bool falls : {false, true}) {
      Fog fog = air(extinction);
      if (falls) fog.falloff_per_m = 2, fog.height_m = -1;
      const auto t = make_world(b, camera, {}, false, glm::dvec4(0), false, fog);
      const Film all = traced(*t, shared_by(0, 16), camera, 8), shared = traced(*t, shared_by(16, 16), camera, 16);
      for (size_t i = 0; i < all.pixels(); ++i) EXPECT_TRUE(std::isfinite(shared.mean(i).x) && shared.mean(i).x >= 0);
      const MeanError truth = mean_of(all), m = mean_of(shared);
      EXPECT_NEAR(m.mean, truth.mean, 4.5 * (m.error + truth.error) + 1e-9 * truth.mean) << extinction << falls;
      EXPECT_LT(m.error, 0.1 * truth.mean) << extinction << falls;
    }
}

// The part of a ray that a spot lights is where something arrives, from every side and for cones up to a half space.
TEST(FogLamps, TheLitPartOfARayIsWhereLightArrives) {
  PunctualLight light;
  light.type = LightType::spot;
  light.intensity = glm::dvec3(1);
  int lit_rays = 0;
  for (uint32_t k = 0; k < 400; ++k) {
    const auto u = [&](uint32_t i) { return 2 * number(16 * k + i) - 1; };
    light.position = {u(0), u(1), u(2)};
    light.direction = glm::normalize(glm::dvec3(u(3), u(4), u(5)));
    const double outer = k % 7 == 0 ? pi / 2 : 0.75 * (1.05 + u(6));
    light.cos_inner = std::cos(outer / 2), light.cos_outer = std::cos(outer);
    light.range_m = k % 3 ? 2 + u(7) : endless;
    const glm::dvec3 origin(3 * u(8), 3 * u(9), 3 * u(10));
    // Some along the axis and across it.
    glm::dvec3 direction = glm::normalize(glm::dvec3(u(11), u(12), u(13)));
    if (k % 11 == 0) direction = light.direction;
    if (k % 13 == 0) direction = glm::normalize(glm::cross(light.direction, direction));
    const Span span{0, 8}, lit = lit_part(light, origin, direction, span);
    if (!lit.empty()) ++lit_rays;
    constexpr int steps = 4000;
    int dark = 0;
    for (int i = 0; i < steps; ++i) {
      const double at = 8 * (i + 0.5) / steps;
      const bool arrives = arriving(light, origin + at * direction).illuminance.x > 0;
      const bool inside = at >= lit.begin_m && at <= lit.end_m;
      EXPECT_TRUE(!arrives || inside) << k << " at " << at << ", not in " << lit.begin_m << " to " << lit.end_m;
      dark += inside && !arrives;
    }
    EXPECT_LE(dark, 2) << k;
  }
  EXPECT_GT(lit_rays, 40);
}

}  // namespace candela::reference::test::reference_fog_lamps
