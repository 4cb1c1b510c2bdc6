// How light is followed: coverage, both ways of meeting a light, and that no schedule changes a byte.
#include <tbb/global_control.h>
#include <numbers>

#include <fstream>

#include "reference_fixture.h"

namespace candela::reference::test {
namespace {

using std::numbers::pi;

Json with_alpha(Json material, const char* mode, double alpha) {
  material["alphaMode"] = mode;
  material["pbrMetallicRoughness"]["baseColorFactor"][3] = alpha;
  material["doubleSided"] = true;
  return material;
}

// A glossy floor under a lamp and a sky, with something in the way of each.
GltfBuilder furnished() {
  GltfBuilder b = empty_scene();
  use_all(b);
  Json glossy = {{"pbrMetallicRoughness", base_color(0.6, 0.5, 0.4)}};
  glossy["pbrMetallicRoughness"]["metallicFactor"] = 0.5;
  glossy["pbrMetallicRoughness"]["roughnessFactor"] = 0.35;
  add_node(b, {{"mesh", add_square_mesh(b, 3, add_material(b, glossy))}});
  Json lamp = emitting(diffuse_material(0.2, 0.2, 0.2), 6);
  lamp["doubleSided"] = true;
  add_node(b, {{"mesh", add_square_mesh(b, 0.5, add_material(b, lamp))},
               {"translation", {0.3, 0.9, 1.2}},
               {"rotation", {0.5, 0, 0, 0.8660254}}});
  add_node(b, {{"mesh", add_sphere_mesh(b, 0.4f, add_material(b, diffuse_material(0.7, 0.2, 0.2)), 12)},
               {"translation", {-0.6, 0, 0.5}}});
  add_node(
      b, {{"mesh", add_square_mesh(b, 0.4, add_material(b, with_alpha(diffuse_material(0.2, 0.9, 0.2), "BLEND", 0.4)))},
          {"translation", {0.4, 0.2, 0.5}}});
  return b;
}
const TestCamera camera_of_furnished{.eye = {0.5, -3, 2.4}, .width = 12, .height = 12};

std::string bytes_of(const Film& film) {
  std::string bytes;
  for (size_t i = 0; i < film.pixels(); ++i) {
    const glm::dvec4 m = film.mean(i);
    const glm::dvec3 v = film.variance(i);
    const double values[8] = {m.x, m.y, m.z, m.w, v.x, v.y, v.z, film.traversal(i)};
    bytes.append(reinterpret_cast<const char*>(values), sizeof values);
  }
  return bytes;
}

}  // namespace

// Two half open layers before a background, from both sides: each covers what the ones before it left open.
TEST(Transport, BlendedSurfacesCoverFrontToBack) {
  for (const double side : {1.0, -1.0}) {
    GltfBuilder b = empty_scene();
    use_all(b);
    const int near = add_square_mesh(b, 4, add_material(b, with_alpha(unlit_material(1, 0, 0), "BLEND", 0.25)));
    const int far = add_square_mesh(b, 4, add_material(b, with_alpha(unlit_material(0, 1, 0), "BLEND", 0.5)));
    add_node(b, {{"mesh", far}, {"translation", {0, 0, -side}}});
    add_node(b, {{"mesh", near}, {"translation", {0, 0, side}}});
    const TestCamera camera{.eye = {0, 0, 4 * side}, .yfov_deg = 20, .width = 4, .height = 4};
    const auto t = make_world(b, camera, {}, false, {0, 0, 2, 1});
    const Film film = traced(*t, centred(), camera, 1);
    const glm::dvec4 expected(0.25, 0.75 * 0.5, 0.75 * 0.5 * 2, 1);
    for (size_t i = 0; i < film.pixels(); ++i)
      for (int c = 0; c < 4; ++c) EXPECT_NEAR(film.mean(i)[c], expected[c], 1e-6) << i << " " << c;
    const Film path = traced(*t, path_settings(), camera, 4096);
    for (int c = 0; c < 3; ++c) {
      const MeanError m = mean_of(path, c);
      EXPECT_NEAR(m.mean, expected[c], 5 * m.error + 1e-9);
    }
  }
}

// Emission is covered as all light of a surface is: a quarter of a lamp is a quarter as bright, in both modes.
TEST(Transport, BlendedEmissionIsCoveredToo) {
  GltfBuilder b = empty_scene();
  use_all(b);
  Json material = with_alpha(diffuse_material(0, 0, 0), "BLEND", 0.25);
  material["emissiveFactor"] = {0.5, 0.25, 1};
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, material))}});
  const TestCamera camera{.eye = {0, 0, 4}, .yfov_deg = 20, .width = 4, .height = 4};
  const auto t = make_world(b, camera, {}, false, {1, 1, 1, 1});
  const glm::dvec4 expected(0.875, 0.8125, 1, 1);
  const Film film = traced(*t, centred(), camera, 1);
  for (size_t i = 0; i < film.pixels(); ++i)
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(film.mean(i)[c], expected[c], 1e-6) << i << " " << c;
  const Film path = traced(*t, path_settings(), camera, 1024);
  for (int c = 0; c < 3; ++c) {
    const MeanError m = mean_of(path, c);
    EXPECT_NEAR(m.mean, expected[c], 5 * m.error + 1e-6) << c;
  }
}

TEST(Transport, MasksAreAllOrNothingAndCulledBacksAreNotSeen) {
  GltfBuilder b = empty_scene();
  use_all(b);
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, with_alpha(unlit_material(1, 0, 0), "MASK", 0.4)))},
               {"translation", {0, 0, 1}}});
  Json kept = with_alpha(unlit_material(0, 1, 0), "MASK", 0.6);
  kept["doubleSided"] = false;
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, kept))}});
  TestCamera camera{.eye = {0, 0, 4}, .yfov_deg = 20, .width = 2, .height = 2};
  EXPECT_EQ(traced(*make_world(b, camera), centred(), camera, 1).mean(0), glm::dvec4(0, 1, 0, 1));
  camera.eye = {0, 0, -4};
  EXPECT_EQ(traced(*make_world(b, camera), centred(), camera, 1).mean(0), glm::dvec4(0));
}

// A half open square dims the light behind it by its coverage; a wall seen from its culled back still blocks.
TEST(Transport, ShadowsKnowCoverage) {
  for (const auto& [mode, alpha, through] :
       {std::tuple("BLEND", 0.25, 0.75), {"MASK", 0.25, 1.0}, {"MASK", 0.75, 0.0}, {"OPAQUE", 0.25, 0.0}}) {
    GltfBuilder b = empty_scene();
    use_all(b);
    add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, diffuse_material(1, 1, 1)))}});
    Json veil = with_alpha(diffuse_material(1, 1, 1), mode, alpha);
    veil["doubleSided"] = false;
    add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, veil))}, {"translation", {3, 0, 1.5}}});
    add_light(b, {{"type", "point"}, {"intensity", 10.0}}, {{"translation", {3, 0, 2}}});
    use_all(b);
    const TestCamera camera{.eye = {3, -2, 1}, .target = {3, 0, 0}, .yfov_deg = 1, .width = 2, .height = 2};
    const auto t = make_world(b, camera);
    TraceSettings open = centred();
    open.visibility = false;
    const double lit = traced(*t, open, camera, 1).mean(0).x;
    EXPECT_GT(lit, 0.1);
    EXPECT_NEAR(traced(*t, centred(), camera, 1).mean(0).x, lit * through, 1e-9) << mode << alpha;
  }
}

// The sky's light on a plane beneath an endless roof is gone, unless only what is near counts.
TEST(Transport, TheAmbientTermIsOccludedWithinItsDistance) {
  GltfBuilder b = empty_scene();
  use_all(b);
  add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, diffuse_material(0.5, 0.5, 0.5)))}});
  Json roof = diffuse_material(0, 0, 0);
  roof["doubleSided"] = true;
  add_node(b, {{"mesh", add_square_mesh(b, 500, add_material(b, roof))}, {"translation", {0, 0, 3}}});
  const TestCamera camera{.eye = {0, -1, 1}, .target = {0, 0, 0}, .yfov_deg = 5, .width = 4, .height = 4};
  const auto t = make_world(b, camera, Sky::constant(glm::dvec3(2)), true);
  TraceSettings settings;
  const auto mean = [&] { return mean_of(traced(*t, settings, camera, 64)).mean; };
  EXPECT_NEAR(mean(), 0, 1e-3);
  settings.ambient_distance_m = 2.5;
  EXPECT_NEAR(mean(), 1, 0.02);
  settings.ambient_distance_m =
      6;  // open where the roof is farther: cos < 1/2, a quarter of the cosine-weighted hemisphere
  EXPECT_NEAR(mean(), 0.25, 0.01);
  settings.visibility = false;
  EXPECT_NEAR(mean(), 1, 0.02);
  settings.ambient = Ambient::off;
  EXPECT_EQ(mean(), 0);
}

// Cosine-weighted openness times the raster techniques' ambient term.
TEST(Transport, OcclusionScalesTheHarmonicAmbient) {
  Surface s;
  s.normal = s.geometric = {0, 1, 0};
  s.base_color = {1, 1, 1};
  s.dielectric_f0 = glm::dvec3(0), s.dielectric_f90 = 0;
  // Of the neutral sky a surface that looks up gets 0.45 + 0.25 * 2/3.
  EXPECT_NEAR(harmonic_ambient(neutral_ambient(), s, {0, 1, 0}).diffuse.x, 0.45 + 0.25 * 2 / 3, 1e-6);
  s.normal = {0, -1, 0};
  EXPECT_NEAR(harmonic_ambient(neutral_ambient(), s, {0, -1, 0}).diffuse.x, 0.45 - 0.25 * 2 / 3, 1e-6);
}

// Each way of meeting a light has the same mean as both together.
TEST(Transport, StrategiesAgree) {
  const auto t = make_world(furnished(), camera_of_furnished, Sky::neutral(), true);
  std::map<Strategy, MeanError> means;
  for (const Strategy strategy : {Strategy::both, Strategy::light, Strategy::brdf}) {
    TraceSettings settings = path_settings();
    settings.strategy = strategy;
    means[strategy] = mean_of(traced(*t, settings, camera_of_furnished, strategy == Strategy::both ? 512 : 1024), 1);
  }
  const MeanError& both = means[Strategy::both];
  EXPECT_LT(both.error, 0.01 * both.mean);
  for (const Strategy strategy : {Strategy::light, Strategy::brdf})
    EXPECT_NEAR(means[strategy].mean, both.mean, 4 * (means[strategy].error + both.error)) << int(strategy);
}

// Bounces are cut by chance and not at a number: with many allowed the mean stays.
TEST(Transport, RouletteIsUnbiased) {
  GltfBuilder b = empty_scene();
  use_all(b);
  const double rho = 0.9;  // 35 bounces until 2.5 % are left
  add_node(b, {{"mesh", add_room_mesh(b, 1, add_material(b, emitting(diffuse_material(rho, rho, rho), 0.1)))}});
  const TestCamera camera{.eye = {0.2, 0.1, 0.3}, .target = {-1, -0.4, 0}, .width = 8, .height = 8};
  const auto t = make_world(b, camera);
  const MeanError m = mean_of(traced(*t, path_settings(), camera, 512));
  EXPECT_NEAR(m.mean, 0.1 / (1 - rho), 5 * m.error);
  // One bounce: what the walls emit, once reflected.
  const MeanError one = mean_of(traced(*t, path_settings(1), camera, 512));
  EXPECT_NEAR(one.mean, 0.1 * (1 + rho), 5 * one.error);
}

TEST(Transport, AnyNumberOfThreadsGivesTheSameBytes) {
  const auto t = make_world(furnished(), camera_of_furnished, Sky::neutral(), true);
  for (const Mode mode : {Mode::direct, Mode::path}) {
    TraceSettings settings = path_settings();
    settings.mode = mode;
    std::string first;
    for (const size_t threads : {1, 2, 5}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      const std::string bytes =
          bytes_of(traced(*t, settings, {.eye = camera_of_furnished.eye, .width = 40, .height = 35}, 4));
      if (first.empty()) first = bytes;
      EXPECT_EQ(bytes, first) << threads;
    }
  }
}

// Costs of camera rays are counted by rays alone, else those of a square of pixels go side by side. Sizes that squares
// do not fill.
TEST(Transport, CountingChangesNoPixel) {
  const TestCamera camera{.eye = camera_of_furnished.eye, .width = 21, .height = 10};
  const auto t = make_world(furnished(), camera, Sky::neutral(), true);
  for (const Mode mode : {Mode::direct, Mode::path}) {
    TraceSettings settings;
    settings.mode = mode;
    const Film beside = traced(*t, settings, camera, 3), counted = traced(*t, settings, camera, 3, false, true);
    for (size_t i = 0; i < beside.pixels(); ++i) {
      EXPECT_EQ(beside.mean(i), counted.mean(i)) << i;
      EXPECT_EQ(beside.variance(i), counted.variance(i)) << i;
      EXPECT_TRUE(std::isnan(beside.traversal(i))) << i;
      EXPECT_GT(counted.traversal(i), 0) << i;
    }
  }
}

// Only a film all of whose samples were counted tells costs; one without goes on from either.
TEST(Transport, CostsAreOfEverySampleOrRefused) {
  const TestCamera& c = camera_of_furnished;
  const auto t = make_world(furnished(), c, Sky::neutral(), true);
  const Integrator integrator(*t->world, TraceSettings{}, c.width, c.height);
  const std::filesystem::path file = ::testing::TempDir() + "candela_reference_costs";
  const Hash128 identity = hash128("this picture");
  const FilmParts costs{.traversal = true};
  const auto go_on = [](const Progress&) { return true; };
  const auto add_to_file = [&](FilmParts parts, uint64_t spp) {
    auto film = Film::load(file, identity, c.width, c.height, parts);
    EXPECT_TRUE(film) << film.error().text();
    if (!film) return Film(c.width, c.height);
    refine(*film, integrator, {.spp = spp}, go_on);
    EXPECT_TRUE(film->save(file, identity));
    return *film;
  };
  Film whole(c.width, c.height, costs);
  refine(whole, integrator, {.spp = 6}, go_on);
  ASSERT_TRUE(Film(c.width, c.height, costs).save(file, identity));
  add_to_file(costs, 2);
  EXPECT_EQ(bytes_of(add_to_file(costs, 6)), bytes_of(whole));

  const Film longer = add_to_file({}, 8);
  const auto refused = Film::load(file, identity, c.width, c.height, costs);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().text().find("heatmap_traversal"), std::string::npos) << refused.error().text();
  Film plain(c.width, c.height);
  refine(plain, integrator, {.spp = 8}, go_on);
  for (size_t i = 0; i < plain.pixels(); ++i) EXPECT_EQ(longer.mean(i), plain.mean(i)) << i;
}

TEST(Transport, AResumedFilmIsTheUninterruptedOne) {
  const auto t = make_world(furnished(), camera_of_furnished, Sky::neutral(), true);
  const TestCamera& c = camera_of_furnished;
  const Integrator integrator(*t->world, path_settings(), c.width, c.height);
  const auto go_on = [](const Progress&) { return true; };
  Film whole(c.width, c.height);
  refine(whole, integrator, {.spp = 21}, go_on);
  EXPECT_EQ(whole.samples(), 21u);

  const std::filesystem::path file = ::testing::TempDir() + "candela_reference_state";
  const Hash128 identity = hash128("this picture");
  Film part(c.width, c.height);
  refine(part, integrator, {.spp = 8}, go_on);
  // An interruption in the middle of a batch leaves the batches before.
  int reports = 0;
  EXPECT_FALSE(refine(part, integrator, {.spp = 21}, [&](const Progress&) { return ++reports < 1; }));
  EXPECT_EQ(part.samples(), 8u);
  ASSERT_TRUE(part.save(file, identity));
  auto loaded = Film::load(file, identity, c.width, c.height);
  ASSERT_TRUE(loaded) << loaded.error().text();
  refine(*loaded, integrator, {.spp = 21}, go_on);
  EXPECT_EQ(bytes_of(*loaded), bytes_of(whole));

  EXPECT_FALSE(Film::load(file, hash128("another"), c.width, c.height));
  EXPECT_FALSE(Film::load(file, identity, c.width + 1, c.height));
  std::string bytes;
  {
    std::ifstream in(file, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  bytes[bytes.size() / 2] ^= 1;
  std::ofstream(file, std::ios::binary) << bytes;
  const auto damaged = Film::load(file, identity, c.width, c.height);
  ASSERT_FALSE(damaged);
  EXPECT_NE(damaged.error().text().find("damaged"), std::string::npos);
}

// Variance and noise by their definitions, from the samples themselves.
TEST(Transport, VarianceAndNoiseAreThoseOfTheSamples) {
  const TestCamera camera{.eye = camera_of_furnished.eye, .width = 5, .height = 4};
  const auto t = make_world(furnished(), camera, Sky::neutral(), true);
  const Integrator integrator(*t->world, path_settings(), camera.width, camera.height);
  for (const int count : {2, 5, 8}) {
    const Film film = traced(*t, path_settings(), camera, count);
    double square = 0, relative = 0;
    for (size_t i = 0; i < film.pixels(); ++i) {
      std::vector<glm::dvec3> x;
      const glm::ivec2 pixel(int(i) % camera.width, int(i) / camera.width);
      for (int s = 0; s < count; ++s) {
        PixelSample sample;
        integrator.sample({&pixel, 1}, uint64_t(s), false, {&sample, 1}, {});
        x.push_back(sample.radiance);
      }
      for (int c = 0; c < 3; ++c) {
        double mean = 0, half[2] = {}, scatter = 0;
        for (int s = 0; s < count; ++s) mean += x[size_t(s)][c] / count;
        for (int s = 0; s < count; ++s) {
          half[s % 2] += x[size_t(s)][c] / ((count + 1 - s % 2) / 2);
          scatter += (x[size_t(s)][c] - mean) * (x[size_t(s)][c] - mean);
        }
        EXPECT_NEAR(film.mean(i)[c], mean, 1e-12 * mean);
        EXPECT_NEAR(film.variance(i)[c], scatter / (count - 1) / count, 1e-12 * (1 + mean * mean));
        const double error = std::pow((half[0] - half[1]) / 2, 2) / (3 * double(film.pixels()));
        square += error, relative += error / (mean * mean + 0.01);
      }
    }
    EXPECT_GT(square, 1e-4);
    EXPECT_NEAR(film.mean_square_error(), square, 1e-12 * (1 + square)) << count;
    EXPECT_NEAR(film.relative_error(), std::sqrt(relative), 1e-12) << count;
  }
}

// The error that two halves tell is the true one: against a film of many more samples.
TEST(Transport, HalvesTellTheNoise) {
  const auto t = make_world(furnished(), camera_of_furnished, Sky::neutral(), true);
  TestCamera camera = camera_of_furnished;
  camera.width = camera.height = 32;
  const Film few = traced(*t, path_settings(2), camera, 16), many = traced(*t, path_settings(2), camera, 512);
  double truth = 0;
  for (size_t i = 0; i < few.pixels(); ++i)
    for (int c = 0; c < 3; ++c) truth += std::pow(few.mean(i)[c] - many.mean(i)[c], 2);
  truth /= 3 * double(few.pixels());
  EXPECT_GT(few.mean_square_error(), truth / 2);
  EXPECT_LT(few.mean_square_error(), truth * 2);
  EXPECT_LT(many.relative_error(), few.relative_error() / 3);
}

TEST(Transport, LimitsEndTheWork) {
  const auto t = make_world(furnished(), camera_of_furnished, Sky::neutral(), true);
  const TestCamera& c = camera_of_furnished;
  const Integrator integrator(*t->world, TraceSettings{}, c.width, c.height);
  const auto go_on = [](const Progress&) { return true; };
  Film by_noise(c.width, c.height), again(c.width, c.height), by_time(c.width, c.height);
  EXPECT_TRUE(refine(by_noise, integrator, {.spp = 4096, .noise = 0.05}, go_on));
  EXPECT_LE(by_noise.relative_error(), 0.05);
  EXPECT_LT(by_noise.samples(), 4096u);
  EXPECT_TRUE(refine(again, integrator, {.noise = 0.05}, go_on));
  EXPECT_EQ(bytes_of(again), bytes_of(by_noise));
  EXPECT_TRUE(refine(by_time, integrator, {.seconds = 1e-9}, go_on));
  EXPECT_GE(by_time.samples(), 2u);
}

}  // namespace candela::reference::test
