// Pictures of fog whose radiance is known in closed form, in both modes.
#include <numbers>

#include "reference_fixture.h"

namespace candela::reference::test::reference_fog {
namespace {

using std::numbers::pi;
const TestCamera camera{.eye = {0, 0, 4}, .yfov_deg = 50, .width = 12, .height = 8};

// Between the planes z = -1 and z = 1.
Fog slab(glm::dvec3 extinction, glm::dvec3 albedo, double g = 0) {
  Fog fog;
  fog.extinction_per_m = extinction, fog.scattering_per_m = extinction * albedo, fog.anisotropy = g;
  fog.lowest.z = -1, fog.highest.z = 1;
  return fog;
}
GltfBuilder nothing() {
  GltfBuilder b = empty_scene();
  use_all(b);
  return b;
}
GltfBuilder with_light(Json light, Json node, GltfBuilder b = nothing()) {
  add_light(b, std::move(light), std::move(node));
  use_all(b);
  return b;
}
GltfBuilder with_sun(double lux) {
  return with_light({{"type", "directional"}, {"intensity", lux}}, {{"translation", {0, 0, 0}}});
}  // along -Z

std::unique_ptr<TestWorld> world_in(const Fog& fog, const GltfBuilder& b, glm::dvec4 background = glm::dvec4(0),
                                    const TestCamera& c = camera) {
  return make_world(b, c, {}, false, background, false, fog);
}
TraceSettings marched(int steps) {
  TraceSettings s = centred();
  s.fog_steps = steps;
  return s;
}
glm::dvec3 direction_of(const TestWorld& t, size_t pixel, const TestCamera& c = camera) {
  const glm::dvec2 centre = glm::dvec2(pixel % size_t(c.width), pixel / size_t(c.width)) + 0.5;
  return glm::normalize(t.world->camera_ray(centre, c.width, c.height).direction);
}
glm::dvec3 exp_of(glm::dvec3 v) { return {std::exp(v.x), std::exp(v.y), std::exp(v.z)}; }

// Single scattering of a sun along the axis of view, over the light's illuminance.
glm::dvec3 slab_lit_along_the_axis(const Fog& fog, glm::dvec3 d) {
  const double mu = -d.z;
  const glm::dvec3 albedo = fog.scattering_per_m / fog.extinction_per_m;
  return albedo * henyey_greenstein(d.z, fog.anisotropy) * (1.0 - exp_of(-2.0 * fog.extinction_per_m * (1 + 1 / mu))) /
         (1 + mu);
}

// All pixels' means of path against an expected value for each, as one number each: within noise.
void expect_mean(const TestWorld& t, const TraceSettings& settings, int spp, double relative_noise,
                 const std::function<glm::dvec3(glm::dvec3)>& expected, const TestCamera& c = camera) {
  const Film film = traced(t, settings, c, spp);
  for (int channel = 0; channel < 3; ++channel) {
    double want = 0;
    // The pixel's mean is its centre's value but for curvature, which few and small pixels do not show: see the
    // callers' fields of view.
    for (size_t i = 0; i < film.pixels(); ++i) want += expected(direction_of(t, i, c))[channel] / double(film.pixels());
    const MeanError m = mean_of(film, channel);
    EXPECT_NEAR(m.mean, want, 4.5 * m.error + 2e-3 * want) << channel;
    EXPECT_LT(m.error, relative_noise * want + 1e-300) << channel;
  }
}

}  // namespace

TEST(Fog, AnAbsorbingSlabWeakensWhatLiesBehindExactly) {
  const Fog fog = slab({0.5, 1, 2}, glm::dvec3(0));
  const auto t = world_in(fog, nothing(), {1, 2, 4, 1});
  for (const Mode mode : {Mode::direct, Mode::path}) {
    const Film film = traced(*t, centred(mode), camera, 1);
    for (size_t i = 0; i < film.pixels(); ++i) {
      const glm::dvec3 clear = exp_of(-fog.extinction_per_m * (2 / -direction_of(*t, i).z));
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(film.mean(i)[c], clear[c] * std::exp2(c), 1e-12);
        EXPECT_NEAR(film.fog_through(i)[c], clear[c], 1e-12);
        EXPECT_EQ(film.fog_light(i)[c], 0);
      }
      EXPECT_NEAR(film.mean(i).w, 1, 1e-15);
    }
  }
}

// A glowing slab with a half open surface amid it, before a background.
TEST(Fog, EmissionAndBlendedSurfacesShareTheRay) {
  Fog fog = slab(glm::dvec3(0.7), glm::dvec3(0));
  fog.emission_per_m = {0.7, 1.4, 0};
  GltfBuilder b = nothing();
  Json veil = unlit_material(0.25, 1, 0.5);
  veil["alphaMode"] = "BLEND";
  veil["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.4;
  add_node(b, {{"mesh", add_square_mesh(b, 9, add_material(b, veil))}});
  const auto t = world_in(fog, b, {3, 3, 3, 0.5});
  const Film film = traced(*t, marched(4), camera, 1);
  for (size_t i = 0; i < film.pixels(); ++i) {
    const double half = std::exp(-0.7 / -direction_of(*t, i).z);
    const glm::dvec3 glow = glm::dvec3(1, 2, 0) * (1 - half), behind = glow + half * glm::dvec3(3),
                     surface(0.25, 1, 0.5);
    const glm::dvec3 light = glow + half * 0.6 * glow, expected = glow + half * (0.4 * surface + 0.6 * behind);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(film.mean(i)[c], expected[c], 1e-6);
      EXPECT_NEAR(film.fog_light(i)[c], light[c], 1e-6);
      EXPECT_NEAR(film.fog_through(i)[c], 0.4 * half + 0.6 * half * half, 1e-6);
    }
    EXPECT_NEAR(film.mean(i).w, 0.4 + 0.6 * (1 - half * half * 0.5), 1e-6)
        << "the background shows through by what fog and veil leave of its alpha";
  }
  const Film path = traced(*t, path_settings(), camera, 2048);
  double expected = 0;
  for (size_t i = 0; i < film.pixels(); ++i) expected += film.mean(i).x / double(film.pixels());
  EXPECT_NEAR(mean_of(path).mean, expected, 4.5 * mean_of(path).error + 1e-3 * expected);
}

TEST(Fog, ASlabUnderASunHasItsClosedForm) {
  for (const double g : {0.0, 0.6, 0.98, -0.98}) {
    const Fog fog = slab({0.3, 1, 3}, {1, 0.9, 0.5}, g);
    const auto t = world_in(fog, with_sun(2));
    const Film film = traced(*t, marched(1024), camera, 1);
    for (size_t i = 0; i < film.pixels(); ++i) {
      const glm::dvec3 expected = 2.0 * slab_lit_along_the_axis(fog, direction_of(*t, i));
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(film.mean(i)[c], expected[c], 2e-4 * expected[c]) << g << " " << c;
        EXPECT_EQ(film.fog_light(i)[c], film.mean(i)[c]);
      }
      const double clear = luminance(exp_of(-fog.extinction_per_m * (2 / -direction_of(*t, i).z)));
      EXPECT_NEAR(film.mean(i).w, 1 - clear, 1e-9);
    }
    TestCamera narrow = camera;
    narrow.yfov_deg = 0.2;
    expect_mean(
        *world_in(fog, with_sun(2), glm::dvec4(0), narrow), path_settings(1), 256, 0.02,
        [&](glm::dvec3 d) { return 2.0 * slab_lit_along_the_axis(fog, d); }, narrow);
  }
}

// From nothing to what is as good as a wall: no light is lost, and none is made.
TEST(Fog, ExtinctionMayBeAnything) {
  for (const double extinction : {1e-12, 1e-8, 1e-3, 1e3, 1e6}) {
    const Fog fog = slab(glm::dvec3(extinction), glm::dvec3(0.8), 0.5);
    const auto t = world_in(fog, with_sun(2));
    const Film film = traced(*t, marched(256), camera, 1);
    for (size_t i = 0; i < film.pixels(); ++i) {
      const double mu = -direction_of(*t, i).z;
      const double expected =
          2 * 0.8 * henyey_greenstein(-mu, 0.5) * -std::expm1(-2 * extinction * (1 + 1 / mu)) / (1 + mu);
      EXPECT_NEAR(film.mean(i).x, expected, 1e-4 * expected) << extinction;
    }
    const Film path = traced(*t, path_settings(1), camera, 64);
    double expected = 0;
    for (size_t i = 0; i < film.pixels(); ++i) expected += film.mean(i).x / double(film.pixels());
    EXPECT_NEAR(mean_of(path).mean, expected, 4.5 * mean_of(path).error + 5e-3 * expected) << extinction;
    EXPECT_LT(mean_of(path).error, 0.05 * expected);
  }
  const auto clear = world_in(slab(glm::dvec3(0), glm::dvec3(1)), with_sun(2), {1, 1, 1, 1});
  for (const Mode mode : {Mode::direct, Mode::path})
    EXPECT_EQ(traced(*clear, centred(mode), camera, 1).mean(5), glm::dvec4(1)) << int(mode);
}

// Emission in fog as dense as a wall, the eye inside: what is emitted over the extinction.
TEST(Fog, TendsToTheSourceOverTheExtinction) {
  Fog fog = slab(glm::dvec3(1e6), glm::dvec3(0));
  fog.lowest.z = -100, fog.highest.z = 100;
  fog.emission_per_m = {1e6, 5e5, 2e6};
  const auto t = world_in(fog, nothing(), {9, 9, 9, 1});
  for (const Mode mode : {Mode::direct, Mode::path})
    for (const int spp : {1, 16})
      EXPECT_EQ(traced(*t, mode == Mode::direct ? TraceSettings{} : path_settings(), camera, spp).mean(7),
                glm::dvec4(1, 0.5, 2, 1));
}

// The inverse square along a ray is a difference of arc tangents where the fog is too thin to weaken light.
TEST(Fog, ALampInThinAir) {
  const Fog fog = slab(glm::dvec3(1e-9), glm::dvec3(1));
  for (const glm::dvec3 at : {glm::dvec3(0.3, -0.2, 0.1), glm::dvec3(0.02, 0.01, 0), glm::dvec3(2, 1, 3)}) {
    const auto t =
        world_in(fog, with_light({{"type", "point"}, {"intensity", 1e9}}, {{"translation", {at.x, at.y, at.z}}}));
    const auto expected = [&](glm::dvec3 d) {
      const double nearest = glm::dot(at - camera.eye, d), aside = glm::length(at - camera.eye - nearest * d);
      return glm::dvec3((std::atan((5 / -d.z - nearest) / aside) - std::atan((3 / -d.z - nearest) / aside)) / aside /
                        (4 * pi));
    };
    const Film film = traced(*t, marched(256), camera, 1);
    for (size_t i = 0; i < film.pixels(); ++i)
      EXPECT_NEAR(film.mean(i).x, expected(direction_of(*t, i)).x, 1e-3 * expected(direction_of(*t, i)).x)
          << at.x << " " << i;
    TestCamera off = camera;
    off.yfov_deg = 4, off.target = {1, 0.8, 0};
    const auto aside =
        world_in(fog, with_light({{"type", "point"}, {"intensity", 1e9}}, {{"translation", {at.x, at.y, at.z}}}),
                 glm::dvec4(0), off);
    expect_mean(*aside, path_settings(1), 512, 0.01, expected, off);
  }
}

// The error of a smooth stretch falls with the square of the steps, whatever the offset; the mean of offsets is right
// for one step.
TEST(Fog, TheMarchConvergesWithTheSquareOfItsSteps) {
  const Fog fog = slab(glm::dvec3(1.5), glm::dvec3(1));
  const auto t = world_in(fog, with_sun(1));
  const auto error = [&](int steps) {
    TraceSettings settings = marched(steps);
    double sum = 0;
    constexpr int seeds = 16;
    for (int seed = 0; seed < seeds; ++seed) {
      settings.sampler.seed = uint64_t(seed);
      const Film film = traced(*t, settings, camera, 1);
      for (size_t i = 0; i < film.pixels(); ++i)
        sum += std::pow(film.mean(i).x / slab_lit_along_the_axis(fog, direction_of(*t, i)).x - 1, 2);
    }
    return std::sqrt(sum / seeds);
  };
  for (const int steps : {8, 16, 32}) EXPECT_NEAR(std::log2(error(steps) / error(2 * steps)), 2, 0.3) << steps;

  TraceSettings one = marched(1);
  one.sampler = {SamplerKind::sobol, 4096, 0};
  TestCamera narrow = camera;
  narrow.yfov_deg = 2;
  const auto small = world_in(fog, with_sun(1), glm::dvec4(0), narrow);
  const MeanError m = mean_of(traced(*small, one, narrow, 1024));
  EXPECT_NEAR(m.mean, slab_lit_along_the_axis(fog, {0, 0, -1}).x, 5e-4 * m.mean);
}

// A wall's shadow reaches into the fog: the sun comes from the side, and of a ray's way through the slab only the part
// above the wall's edge is lit.
TEST(Fog, ShadowsReachIntoIt) {
  Fog fog = slab(glm::dvec3(1e-6), glm::dvec3(1));
  fog.lowest.x = -5, fog.highest.x = 5;  // without an end the sun would lie behind all of it
  GltfBuilder b = nothing();
  // A roof at x = 1 over the half z < 0 of the slab; the sun shines along -X.
  Json roof = diffuse_material(1, 1, 1);
  roof["doubleSided"] = true;
  add_node(b, {{"mesh", add_square_mesh(b, 50, add_material(b, roof))},
               {"translation", {60, 0, -50}},
               {"rotation", {0, 0.70710678, 0, 0.70710678}}});
  b = with_light({{"type", "directional"}, {"intensity", 1e6}}, {{"rotation", {0, 0.70710678, 0, 0.70710678}}}, b);
  TestCamera narrow = camera;
  narrow.yfov_deg = 1;
  const auto t = world_in(fog, b, glm::dvec4(0), narrow);
  TraceSettings settings = marched(512);
  const double hard = mean_of(traced(*t, settings, narrow, 1)).mean;
  settings.visibility = false;
  const double open = mean_of(traced(*t, settings, narrow, 1)).mean;
  EXPECT_NEAR(open, 2 / (4 * pi), 1e-3);
  EXPECT_NEAR(hard, open / 2, 2e-3 * open);
  const MeanError path = mean_of(traced(*t, path_settings(1), narrow, 256));
  EXPECT_NEAR(path.mean, open / 2, 4.5 * path.error);
}

// Light on its way to a surface, and back from it, goes through the fog.
TEST(Fog, LightOnSurfacesComesThroughIt) {
  const Fog fog = slab({0.2, 0.6, 1}, glm::dvec3(0));
  GltfBuilder b = nothing();
  add_node(b, {{"mesh", add_square_mesh(b, 9, add_material(b, diffuse_material(0.8, 0.8, 0.8)))}});
  b = with_light({{"type", "directional"}, {"intensity", 3.0}}, {{"translation", {0, 0, 0}}}, b);
  const auto t = world_in(fog, b);
  for (const Mode mode : {Mode::direct, Mode::path}) {
    TraceSettings settings = centred(mode);
    settings.most_bounces = mode == Mode::path ? 1 : 0;
    const Film film = traced(*t, settings, camera, 1);
    for (size_t i = 0; i < film.pixels(); ++i)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(film.mean(i)[c],
                    3 * 0.8 / pi * std::exp(-fog.extinction_per_m[c] * (1 + 1 / -direction_of(*t, i).z)), 1e-6)
            << int(mode);
  }
}

// Air that absorbs nothing, in light that comes from everywhere alike, cannot be seen.
TEST(Fog, TheWhiteFurnaceHidesIt) {
  for (const double g : {0.0, 0.9, -0.7}) {
    Fog fog = slab({0.5, 1, 1.5}, glm::dvec3(1), g);
    fog.lowest = glm::dvec3(-1), fog.highest = glm::dvec3(1);
    const auto t = make_world(nothing(), camera, Sky::constant(glm::dvec3(1)), true, glm::dvec4(0), false, fog);
    const Film film = traced(*t, path_settings(), camera, 512);
    for (int c = 0; c < 3; ++c) {
      const MeanError m = mean_of(film, c);
      EXPECT_NEAR(m.mean, 1, 4.5 * m.error) << g << " " << c;
      EXPECT_LT(m.error, 0.01);
    }
  }
}

// A pane of glass that bends and reflects nothing stands in the fog: what lies behind is weakened by the same way
// through fog, once, and a body of such glass holds none.
TEST(Fog, GoesOnBehindGlass) {
  const Fog fog = slab({0.5, 1, 2}, glm::dvec3(0));
  const double body_m = 0.75;
  for (const bool body : {false, true}) {
    GltfBuilder b = nothing();
    const int material = add_material(b, glass_material(1, 0, body ? body_m : 0));
    if (body)
      add_slab(b, 200, body_m, material);
    else
      for (const double z : {0.5, -0.25})
        add_node(b, {{"mesh", add_square_mesh(b, 200, material)}, {"translation", {0, 0, z}}});
    const auto t = make_world(b, camera, {}, false, {1, 2, 4, 1}, true, fog);
    const Film film = traced(*t, centred(Mode::path), camera, 1);
    for (size_t i = 0; i < film.pixels(); ++i)
      for (int c = 0; c < 3; ++c) {
        const double way = (2 - (body ? body_m : 0)) / -direction_of(*t, i).z;
        EXPECT_NEAR(film.mean(i)[c], (1 << c) * std::exp(-fog.extinction_per_m[c] * way), 1e-5) << body;
      }
  }
  // Light that scatters about the panes comes from everywhere alike: neither is seen.
  Fog white = slab({0.5, 1, 1.5}, glm::dvec3(1), 0.3);
  white.lowest = glm::dvec3(-1), white.highest = glm::dvec3(1);
  GltfBuilder b = nothing();
  const int pane = add_square_mesh(b, 3, add_material(b, glass_material(1.5, 0, 0)));
  for (const double z : {0.5, -0.25}) add_node(b, {{"mesh", pane}, {"translation", {0, 0, z}}});
  const auto t = make_world(b, camera, Sky::constant(glm::dvec3(1)), true, glm::dvec4(0), true, white);
  const Film film = traced(*t, path_settings(), camera, 512);
  for (int c = 0; c < 3; ++c) {
    const MeanError m = mean_of(film, c);
    EXPECT_NEAR(m.mean, 1, 4.5 * m.error) << c;
    EXPECT_LT(m.error, 0.01);
  }
}

// Direct is what path is with one bounce: lamps, a spot, a sun and the sky on a floor with a wall in falling, coloured
// fog.
TEST(Fog, DirectAgreesWithPathsOfOneBounce) {
  GltfBuilder b = nothing();
  add_node(b, {{"mesh", add_square_mesh(b, 6, add_material(b, diffuse_material(0.6, 0.5, 0.4)))},
               {"rotation", {-0.70710678, 0, 0, 0.70710678}}});
  Json wall = diffuse_material(0.3, 0.3, 0.6);
  wall["doubleSided"] = true;
  add_node(b, {{"mesh", add_square_mesh(b, 0.7, add_material(b, wall))}, {"translation", {-0.4, 0.8, 0.3}}});
  add_light(b, {{"type", "point"}, {"intensity", 8.0}, {"range", 5.0}}, {{"translation", {0.5, 1, -0.8}}});
  add_light(b, {{"type", "spot"}, {"intensity", 60.0}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}},
            {{"translation", {1, 3, 0}}, {"rotation", {-0.70710678, 0, 0, 0.70710678}}});
  add_light(b, {{"type", "directional"}, {"intensity", 2.0}}, {{"rotation", {-0.5, 0, 0, 0.8660254}}});
  use_all(b);
  Fog fog;
  fog.extinction_per_m = {0.15, 0.3, 0.6}, fog.scattering_per_m = {0.15, 0.25, 0.2};
  fog.anisotropy = 0.5, fog.falloff_per_m = 0.4, fog.height_m = 0.5;
  const TestCamera c{.eye = {0.4, 1.2, 5}, .target = {0, 1, 0}, .width = 16, .height = 12};
  const auto t = make_world(b, c, Sky::neutral(), true, glm::dvec4(0), false, fog);
  TraceSettings direct;
  direct.fog_steps = 8;
  const Film a = traced(*t, direct, c, 256), p = traced(*t, path_settings(1), c, 2048);
  for (int channel = 0; channel < 3; ++channel) {
    const MeanError da = mean_of(a, channel), pa = mean_of(p, channel);
    EXPECT_NEAR(da.mean, pa.mean, 4.5 * (da.error + pa.error)) << channel;
    EXPECT_LT(pa.error, 0.01 * pa.mean);
    double light[2] = {0, 0}, clear[2] = {0, 0};
    for (size_t i = 0; i < a.pixels(); ++i) {
      light[0] += a.fog_light(i)[channel], light[1] += p.fog_light(i)[channel];
      clear[0] += a.fog_through(i)[channel], clear[1] += p.fog_through(i)[channel];
    }
    EXPECT_NEAR(light[1], light[0], 0.04 * light[0]);
    EXPECT_NEAR(clear[1], clear[0], 0.01 * clear[0]);
    EXPECT_GT(light[0], 0.1 * da.mean * double(a.pixels())) << "there is fog to be seen";
  }
}

// Every mean is the same by either way of meeting the sky, and emissive triangles light the fog.
TEST(Fog, StrategiesAgree) {
  GltfBuilder b = nothing();
  Json lamp = emitting(diffuse_material(0.2, 0.2, 0.2), 6);
  lamp["doubleSided"] = true;
  add_node(b, {{"mesh", add_square_mesh(b, 0.5, add_material(b, lamp))},
               {"translation", {0.6, 0.5, 0}},
               {"rotation", {0.5, 0, 0, 0.8660254}}});
  const Fog fog = slab({0.4, 0.6, 0.8}, glm::dvec3(0.9), 0.4);
  const TestCamera c{.width = 8, .height = 8};
  const auto t = make_world(b, c, Sky::neutral(), true, glm::dvec4(0), false, fog);
  std::map<Strategy, MeanError> means;
  for (const Strategy strategy : {Strategy::both, Strategy::light, Strategy::brdf}) {
    TraceSettings settings = path_settings(3);
    settings.strategy = strategy;
    means[strategy] = mean_of(traced(*t, settings, c, 2048), 1);
  }
  for (const Strategy strategy : {Strategy::light, Strategy::brdf})
    EXPECT_NEAR(means[strategy].mean, means[Strategy::both].mean,
                4.5 * (means[strategy].error + means[Strategy::both].error))
        << int(strategy);
  EXPECT_LT(means[Strategy::both].error, 0.01 * means[Strategy::both].mean);
}

TEST(Fog, AFilmOfItIsResumed) {
  const auto t = world_in(slab(glm::dvec3(1), glm::dvec3(1)), with_sun(1));
  const std::filesystem::path file = ::testing::TempDir() + "candela_fog_state";
  const Film film = traced(*t, TraceSettings{}, camera, 4);
  ASSERT_TRUE(film.save(file, {}));
  const auto loaded = Film::load(file, {}, camera.width, camera.height, {.fog = true});
  ASSERT_TRUE(loaded) << loaded.error().text();
  for (size_t i = 0; i < film.pixels(); ++i) {
    EXPECT_EQ(loaded->fog_light(i), film.fog_light(i));
    EXPECT_EQ(loaded->fog_through(i), film.fog_through(i));
    EXPECT_EQ(loaded->mean(i), film.mean(i));
  }
  EXPECT_FALSE(Film::load(file, {}, camera.width, camera.height)) << "a state with fog is none without";
}

// A medium in two parts, each with some of its extinction, scattering and glow, is that medium: noise aside in both
// modes, and what is left of the background to the last digits.
TEST(ReferenceFog, SeveralMediaAreTheirSum) {
  Fog whole;
  whole.extinction_per_m = {0.3, 0.5, 0.8}, whole.scattering_per_m = {0.25, 0.3, 0.2};
  whole.emission_per_m = {0.02, 0.0, 0.05};
  whole.anisotropy = 0.4, whole.falloff_per_m = 0.3;
  whole.lowest = {-4, -3, -2}, whole.highest = {4, 3, 1};
  Fog a = whole, b = whole;
  a.extinction_per_m *= 0.25, a.scattering_per_m *= 0.4, a.emission_per_m *= 0.1;
  b.extinction_per_m -= a.extinction_per_m, b.scattering_per_m -= a.scattering_per_m;
  b.emission_per_m -= a.emission_per_m;
  const GltfBuilder lit = with_light({{"type", "point"}, {"intensity", 30.0}}, {{"translation", {0.5, 0.7, -0.6}}});
  const auto one = make_world(lit, camera, Sky::constant(glm::dvec3(0.5)), true, glm::dvec4(0), false, whole);
  const auto two = make_world(lit, camera, Sky::constant(glm::dvec3(0.5)), true, glm::dvec4(0), false, a, 0, {}, {b});
  for (const bool path : {false, true}) {
    TraceSettings settings = path ? path_settings(1) : TraceSettings{};
    settings.fog_steps = path ? 0 : 32;
    // What differs is noise: the worst channel of direct was apart by 2.3e-3 at 64 samples, 7.7e-4 at 256 and 8e-6 at
    // 2,048; that of path by 5e-5.
    const int spp = path ? 1024 : 256;
    const Film of_one = traced(*one, settings, camera, spp), of_two = traced(*two, settings, camera, spp);
    glm::dvec3 light[2] = {};
    for (size_t i = 0; i < of_one.pixels(); ++i) {
      light[0] += of_one.fog_light(i), light[1] += of_two.fog_light(i);
      for (int c = 0; c < 3 && !path; ++c) EXPECT_NEAR(of_one.fog_through(i)[c], of_two.fog_through(i)[c], 1e-12);
    }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(light[1][c], light[0][c], 2e-3 * light[0][c]) << path;
  }
}

}  // namespace candela::reference::test::reference_fog
