// The terms that beauty is divided into: each against its closed form, their sum, and that asking for them changes
// nothing.
#include <numbers>

#include "reference/glass_light.h"
#include "reference_fixture.h"

namespace candela::reference::test::reference_terms {
namespace {

using std::numbers::pi;
const glm::dvec3 albedo(0.8, 0.4, 0.2);
const TestCamera above{.eye = {0, 0, 4}, .yfov_deg = 20, .width = 6, .height = 6};

Json covering(Json material, const char* mode, double alpha) {
  material["alphaMode"] = mode;
  material["pbrMetallicRoughness"]["baseColorFactor"][3] = alpha;
  material["doubleSided"] = true;
  return material;
}
GltfBuilder plane(const Json& material) {
  GltfBuilder b = empty_scene();
  use_all(b);
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, material))}});
  return b;
}
// Straight down.
void add_sun(GltfBuilder& b, double lux) {
  add_light(b, {{"type", "directional"}, {"intensity", lux}}, {{"translation", {0, 0, 3}}});
  use_all(b);
}

glm::dvec3 sum_of_terms(const Film& film, size_t pixel) {
  glm::dvec3 sum = film.fog_light(pixel);
  for (size_t t = 0; t < term_count; ++t) sum += film.term(Term(t), pixel);
  return sum;
}
void expect_near(glm::dvec3 value, glm::dvec3 expected, double tolerance, const std::string& what) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], expected[c], tolerance) << what << ", channel " << c;
}
// One term is `expected`, and every other one is 0.
void expect_only(const Film& film, Term term, glm::dvec3 expected, double relative = 1e-6) {
  for (size_t i = 0; i < film.pixels(); ++i)
    for (size_t t = 0; t < term_count; ++t)
      if (Term(t) == term)
        expect_near(film.term(term, i), expected, relative * std::max(largest(expected), 1e-3), "the term itself");
      else
        EXPECT_EQ(film.term(Term(t), i), glm::dvec3(0)) << name_of(Term(t)) << " at " << i;
}

// Everything that a term can come from, with masks, blended surfaces, emission, unlit surfaces, glass and fog.
GltfBuilder everything() {
  GltfBuilder b = empty_scene();
  use_all(b);
  Json glossy = {{"pbrMetallicRoughness", base_color(0.6, 0.5, 0.4)}};
  glossy["pbrMetallicRoughness"]["metallicFactor"] = 0.5;
  glossy["pbrMetallicRoughness"]["roughnessFactor"] = 0.35;
  add_node(b, {{"mesh", add_square_mesh(b, 3, add_material(b, glossy))}});
  const auto add_square = [&](const Json& material, glm::dvec3 at, float half) {
    add_node(b, {{"mesh", add_square_mesh(b, half, add_material(b, material))}, {"translation", {at.x, at.y, at.z}}});
  };
  add_square(emitting(diffuse_material(0.2, 0.2, 0.3), 3), {-0.7, -0.6, 0.4}, 0.3f);
  add_square(covering(diffuse_material(0.2, 0.9, 0.2), "BLEND", 0.4), {0.5, 0.2, 0.9}, 0.5f);
  add_square(covering(unlit_material(0.9, 0.2, 0.2), "BLEND", 0.3), {0.2, 0.6, 1.2}, 0.4f);
  add_square(covering(diffuse_material(0.9, 0.9, 0.2), "MASK", 0.7), {-0.5, 0.7, 0.5}, 0.3f);
  add_square(unlit_material(0.1, 0.3, 0.9), {0.8, -0.9, 0.3}, 0.3f);
  add_square(glass_material(1.5, 0, 0, {0.9, 0.95, 0.9}), {-0.1, -0.2, 1.5}, 0.4f);
  add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {1.2, 0.5, 2}}});
  add_light(b, {{"type", "spot"}, {"intensity", 30.0}, {"spot", {{"outerConeAngle", 0.6}}}},
            {{"translation", {-1, 0.2, 2}}});
  add_sun(b, 2);
  return b;
}
// The plane ends within the picture: background is seen beside it.
const TestCamera over_everything{.eye = {0.4, -4.5, 3.2}, .width = 14, .height = 12};

}  // namespace

// Lights of each kind above a diffuse plane: a term of their own, by their closed forms.
TEST(Terms, KindsOfLightAreKeptApart) {
  for (const Mode mode : {Mode::direct, Mode::path}) {
    const auto film_of = [&](Json light) {
      GltfBuilder b = plane(diffuse_material(albedo.x, albedo.y, albedo.z));
      add_light(b, std::move(light), {{"translation", {0, 0, 2}}});
      use_all(b);
      TestCamera camera = above;
      camera.yfov_deg = 0.05;
      return traced(*make_world(b, camera), centred(mode), camera, 1, true);
    };
    // Path chooses among lights with a probability of 1 where there is but one.
    expect_only(film_of({{"type", "directional"}, {"intensity", 3.0}}), Term::direct_sun, albedo * (3 / pi));
    expect_only(film_of({{"type", "point"}, {"intensity", 8.0}}), Term::direct_point, albedo * (8 / 4.0 / pi), 1e-4);
    expect_only(film_of({{"type", "spot"}, {"intensity", 8.0}, {"spot", {{"outerConeAngle", 0.5}}}}), Term::direct_spot,
                albedo * (8 / 4.0 / pi), 1e-4);
  }
}

// What gives light by itself, the background, and unlit surfaces, of which blended ones show the fraction that they
// cover.
TEST(Terms, EmissionAndBackgroundShareAPixelByCoverage) {
  for (const Mode mode : {Mode::direct, Mode::path}) {
    SCOPED_TRACE(mode == Mode::path ? "path" : "direct");
    const int spp = mode == Mode::path ? 8192 : 1;
    GltfBuilder b = empty_scene();
    use_all(b);
    const int emitter = add_material(b, covering(emitting(diffuse_material(0, 0, 0), 4), "BLEND", 0.25));
    const int picture = add_material(b, covering(unlit_material(0, 1, 0), "BLEND", 0.5));
    add_node(b, {{"mesh", add_square_mesh(b, 4, emitter)}, {"translation", {0, 0, 1}}});
    add_node(b, {{"mesh", add_square_mesh(b, 4, picture)}});
    TestCamera camera = above;
    camera.width = camera.height = 4;
    const auto t = make_world(b, camera, {}, false, {0, 0, 2, 1});
    const Film film = traced(*t, mode == Mode::path ? path_settings() : centred(), camera, spp, true);
    glm::dvec3 emission(0), background(0);
    for (size_t i = 0; i < film.pixels(); ++i) {
      emission += film.term(Term::emission, i) / double(film.pixels());
      background += film.term(Term::background, i) / double(film.pixels());
      EXPECT_EQ(film.term(Term::indirect, i), glm::dvec3(0));
    }
    const double noise = mode == Mode::path ? 0.03 : 1e-6;
    expect_near(emission, {0.25 * 4, 0.25 * 4 + 0.75 * 0.5, 0.25 * 4}, noise, "emission");
    expect_near(background, {0, 0, 0.75 * 0.5 * 2}, noise, "background");
  }
}

// What glows all over blocks no lamp; of the sky it hides as much as anything, however near the sky's rays end.
TEST(Terms, WhatGlowsHidesTheSkyButNoLamp) {
  for (const bool glows : {true, false}) {
    Json bulb = diffuse_material(0.5, 0.5, 0.5);
    if (glows) bulb["emissiveFactor"] = {1, 0.5, 0};
    GltfBuilder b = empty_scene();
    use_all(b);
    add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, bulb))}});
    const auto t = make_world(b);
    ASSERT_TRUE(t);
    const SurfacePoint from{glm::vec3(0, 0, -2) - glm::vec3(t->view.position), {}, 0};
    const glm::dvec3 up(0, 0, 1);
    for (const double distance_m : {4.0, std::numeric_limits<double>::infinity()}) {
      EXPECT_EQ(transmittance(*t->world, from, up, distance_m), 0);
      EXPECT_EQ(light_through(*t->world, from, up, distance_m, nullptr), glm::dvec3(0));
    }
    EXPECT_EQ(transmittance(*t->world, from, up, 4, nullptr, true), glows ? 1 : 0);
    EXPECT_EQ(light_through(*t->world, from, up, 4, nullptr, nullptr, true), glm::dvec3(glows ? 1 : 0));
  }
}

// Under an even sky a diffuse plane shows albedo times its radiance, in the diffuse term alone, and a metal nothing in
// it. The raster techniques' own ambient term is divided by the same names.
TEST(Terms, AmbientLightIsDividedByItsLobes) {
  const glm::dvec3 radiance(2, 1, 0.5);
  for (const Ambient ambient : {Ambient::traced, Ambient::occlusion})
    for (const Mode mode : {Mode::direct, Mode::path}) {
      if (mode == Mode::path && ambient != Ambient::traced) continue;
      TraceSettings settings = path_settings();
      settings.mode = mode, settings.ambient = ambient;
      const auto mean = [&](const Json& material, Term term) {
        const auto t = make_world(plane(material), above, Sky::constant(radiance), true);
        const Film film = traced(*t, settings, above, 512, true);
        glm::dvec3 sum(0);
        for (size_t i = 0; i < film.pixels(); ++i) {
          sum += film.term(term, i) / double(film.pixels());
          expect_near(sum_of_terms(film, i), glm::dvec3(film.mean(i)), 1e-12, "sum");
          EXPECT_EQ(film.term(Term::indirect, i), glm::dvec3(0));
        }
        return sum;
      };
      const Json diffuse = diffuse_material(albedo.x, albedo.y, albedo.z);
      Json metal = {{"pbrMetallicRoughness", base_color(0.9, 0.8, 0.7)}};
      metal["pbrMetallicRoughness"]["metallicFactor"] = 1;
      metal["pbrMetallicRoughness"]["roughnessFactor"] = 0.3;
      const bool traced_sky = ambient == Ambient::traced;
      if (traced_sky) expect_near(mean(diffuse, Term::ambient_diffuse), albedo * radiance, 0.01, "diffuse");
      expect_near(mean(diffuse, Term::ambient_specular), glm::dvec3(0), 1e-12, "no specular");
      expect_near(mean(metal, Term::ambient_diffuse), glm::dvec3(0), 1e-12, "no diffuse");
      if (traced_sky) {
        EXPECT_GT(mean(metal, Term::ambient_specular).x, 1.5);
      }
    }
}

// The raster techniques' ambient term under an even sky of radiance 1.
TEST(Terms, TheHarmonicAmbientIsDividedByItsLobes) {
  AmbientSh even{};
  even[0] = glm::vec3(1 / 0.2820947918f);
  Surface s;
  s.normal = s.geometric = {0, 0, 1};
  s.base_color = albedo, s.roughness = 0.6;
  s.dielectric_f0 = glm::dvec3(0), s.dielectric_f90 = 0;
  const HarmonicAmbient matt = harmonic_ambient(even, s, {0, 0, 1});
  expect_near(matt.diffuse, albedo, 1e-6, "a base alone is diffuse");
  expect_near(matt.specular, glm::dvec3(0), 1e-12, "and nothing else");
  s.dielectric_f0 = glm::dvec3(0.04), s.dielectric_f90 = 1;
  const HarmonicAmbient varnished = harmonic_ambient(even, s, {0, 0, 1});
  // A dielectric reflects the same fraction of every colour, and the base has what it leaves or nearly so.
  EXPECT_GT(varnished.specular.x, 0.02);
  expect_near(varnished.specular, glm::dvec3(varnished.specular.x), 1e-9, "no hue");
  expect_near(varnished.diffuse / albedo, glm::dvec3(1 - varnished.specular.x), 0.02, "the rest");
  s.metallic = 1;
  const HarmonicAmbient metal = harmonic_ambient(even, s, {0, 0, 1});
  expect_near(metal.diffuse, glm::dvec3(0), 1e-12, "a metal has no base");
  EXPECT_GT(metal.specular.x, 0.4);
}

// A sun straight above, half of it behind a square; a lamp's shadow is no part of the layer.
TEST(Terms, ShadowIsTheShareOfTheSunThatArrives) {
  for (const Mode mode : {Mode::direct, Mode::path})
    for (const auto& [alpha_mode, alpha, open] :
         {std::tuple("OPAQUE", 1.0, 0.0), {"BLEND", 0.25, 0.75}, {"MASK", 0.25, 1.0}}) {
      SCOPED_TRACE(fmt::format("{} {}", mode == Mode::path ? "path" : "direct", alpha_mode));
      GltfBuilder b = plane(diffuse_material(0.5, 0.5, 0.5));
      const int blocker = add_material(b, covering(diffuse_material(0, 0, 0), alpha_mode, alpha));
      // Above the camera: it blocks the sun over the half of the picture with x > 0, and is not seen.
      add_node(b, {{"mesh", add_square_mesh(b, 4, blocker)}, {"translation", {4, 0, 6}}});
      add_node(b, {{"mesh", add_square_mesh(b, 0.05, blocker)}, {"translation", {-1.9, 0, 1.8}}});
      add_light(b, {{"type", "point"}, {"intensity", 5.0}}, {{"translation", {-2, 0, 2}}});
      add_sun(b, 3);
      const auto t = make_world(b, above);
      const Film film = traced(*t, centred(mode), above, 1, true);
      for (size_t i = 0; i < film.pixels(); ++i) {
        const double expected = int(i) % above.width >= above.width / 2 ? open : 1;
        EXPECT_NEAR(film.shadow(i), expected, 1e-9) << i;
        expect_near(film.term(Term::direct_sun, i), glm::dvec3(0.5 * 3 / pi * expected), 1e-9, "direct_sun");
      }
      TraceSettings without = centred();
      without.visibility = false;
      const Film lit = traced(*t, without, above, 1, true);
      for (size_t i = 0; i < lit.pixels(); ++i) EXPECT_EQ(lit.shadow(i), 1) << i;
    }
}

// Blended surfaces count by what they cover; what takes no light counts as open.
TEST(Terms, ShadowIsTheMeanOverWhatIsSeen) {
  GltfBuilder b = plane(diffuse_material(0.5, 0.5, 0.5));
  add_node(b, {{"mesh", add_square_mesh(b, 4, add_material(b, covering(unlit_material(1, 1, 1), "BLEND", 0.4)))},
               {"translation", {0, 0, 1}}});
  const int roof = add_material(b, diffuse_material(0, 0, 0));
  add_node(b, {{"mesh", add_square_mesh(b, 4, roof)}, {"translation", {0, 0, 6}}});
  add_sun(b, 3);
  const Film film = traced(*make_world(b, above), centred(), above, 1, true);
  for (size_t i = 0; i < film.pixels(); ++i) EXPECT_NEAR(film.shadow(i), double(0.4f), 1e-12) << i;
}

// Under an endless roof at height h a direction meets it at h over its cosine: the fraction (h/R)^2 of the light by
// cosine comes from beyond a radius R. A blended roof hides by its coverage, and in direct the sky's light follows the
// look.
TEST(Terms, OcclusionIsTheShareThatNearSurfacesLeave) {
  constexpr double height = 6, radius = 8, strength = 0.8, radiance = 0.7;
  const double beyond = height * height / (radius * radius);
  for (const Mode mode : {Mode::direct, Mode::path})
    for (const auto& [alpha_mode, alpha] : {std::pair("OPAQUE", 1.0), std::pair("BLEND", 0.25)}) {
      GltfBuilder b = plane(diffuse_material(0.5, 0.5, 0.5));
      const int roof = add_material(b, covering(diffuse_material(0, 0, 0), alpha_mode, alpha));
      add_node(b, {{"mesh", add_square_mesh(b, 100, roof)}, {"translation", {0, 0, height}}});
      const Occlusion look{radius, 0, strength};
      const auto t =
          make_world(b, above, Sky::constant(glm::dvec3(radiance)), false, glm::dvec4(0), false, {}, 0, look);
      const Film film = traced(*t, mode == Mode::path ? path_settings() : centred(), above, 512, true);
      double open = 0;
      glm::dvec3 ambient(0);
      for (size_t i = 0; i < film.pixels(); ++i) {
        open += film.occlusion(i) / double(film.pixels());
        ambient += film.term(Term::ambient_diffuse, i) / double(film.pixels());
      }
      const double expected = 1 - strength * alpha * (1 - beyond);
      EXPECT_NEAR(open, expected, 0.005) << alpha_mode;
      if (mode == Mode::direct) {
        EXPECT_NEAR(ambient.x, 0.5 * radiance * expected, 0.02 * radiance) << alpha_mode;
      }
    }
}

// A closed room whose walls emit E and reflect rho: the walls show E/(1 - rho), of which they emit E themselves. What
// the model of direct leaves out is the rest, all of it.
TEST(Terms, IndirectIsWhatDirectLeavesOut) {
  GltfBuilder b = empty_scene();
  use_all(b);
  const double rho = 0.6, emitted = 0.5;
  add_node(b, {{"mesh", add_room_mesh(b, 1, add_material(b, emitting(diffuse_material(rho, rho, rho), emitted)))}});
  const TestCamera camera{.eye = {0.2, 0.1, 0.3}, .target = {-1, -0.4, 0}, .yfov_deg = 90, .width = 8, .height = 8};
  const Film film = traced(*make_world(b, camera), path_settings(), camera, 512, true);
  const MeanError all = mean_of(film);
  double indirect = 0;
  for (size_t i = 0; i < film.pixels(); ++i) {
    expect_near(film.term(Term::emission, i), glm::dvec3(emitted), 1e-6, "emission");
    indirect += film.term(Term::indirect, i).x / double(film.pixels());
  }
  EXPECT_NEAR(indirect, emitted * rho / (1 - rho), 5 * all.error);
}

// In both modes a term is the same quantity: path's noise apart, lights and sky give what they give in direct.
TEST(Terms, PathAndDirectAgreeOnWhatComesStraight) {
  const auto t = make_world(everything(), over_everything, Sky::neutral(), true);
  TraceSettings settings;
  settings.fog_steps = 0;
  const auto means = [&](Mode mode, int spp) {
    settings.mode = mode;
    const Film film = traced(*t, settings, over_everything, spp, true);
    std::array<double, term_count> sums{};
    for (size_t i = 0; i < film.pixels(); ++i)
      for (size_t k = 0; k < term_count; ++k) sums[k] += film.term(Term(k), i).y / double(film.pixels());
    return sums;
  };
  const auto direct = means(Mode::direct, 64), path = means(Mode::path, 1024);
  for (size_t k = 0; k < term_count; ++k) {
    if (Term(k) == Term::indirect) continue;
    if (Term(k) == Term::reflections || Term(k) == Term::volumetric) {  // of a look that has them
      EXPECT_EQ(direct[k], 0);
      EXPECT_EQ(path[k], 0);
      continue;
    }
    EXPECT_GT(direct[k], 0.003) << name_of(Term(k));
    EXPECT_NEAR(path[k], direct[k], 0.04 * direct[k]) << name_of(Term(k));
  }
  EXPECT_EQ(direct[size_t(Term::indirect)], 0);
  EXPECT_GT(path[size_t(Term::indirect)], 0.01);
}

// Whatever is in the picture: the terms and fog's light sum to beauty, and every bit that was there without them is
// there with them.
TEST(Terms, SumToBeautyAndChangeNoBitOfIt) {
  const Fog fog{.extinction_per_m = {0.1, 0.15, 0.2},
                .scattering_per_m = {0.08, 0.1, 0.1},
                .emission_per_m = {0.01, 0.02, 0.01},
                .lowest = glm::dvec3(-5),
                .highest = glm::dvec3(5)};
  for (const bool foggy : {false, true})
    for (const bool glass : {false, true})
      for (const Mode mode : {Mode::direct, Mode::path})
        for (const Ambient ambient : {Ambient::traced, Ambient::occlusion}) {
          if (mode == Mode::path && ambient == Ambient::occlusion) continue;
          SCOPED_TRACE(fmt::format("fog {} glass {} mode {} ambient {}", foggy, glass, int(mode), int(ambient)));
          const auto t = make_world(everything(), over_everything, Sky::neutral(), true, glm::dvec4(0), glass,
                                    foggy ? std::optional(fog) : std::nullopt);
          TraceSettings settings;
          settings.mode = mode, settings.ambient = ambient, settings.fog_steps = foggy ? 4 : 0;
          const Film alone = traced(*t, settings, over_everything, 6),
                     divided = traced(*t, settings, over_everything, 6, true),
                     counted = traced(*t, settings, over_everything, 6, true, true);
          ASSERT_TRUE(divided.has_terms());
          EXPECT_FALSE(alone.has_terms());
          double largest_fraction = 0;
          for (size_t i = 0; i < alone.pixels(); ++i) {
            EXPECT_EQ(alone.mean(i), divided.mean(i)) << i;
            EXPECT_EQ(alone.variance(i), divided.variance(i)) << i;
            EXPECT_EQ(alone.fog_light(i), divided.fog_light(i)) << i;
            EXPECT_EQ(counted.mean(i), divided.mean(i)) << i;
            const glm::dvec3 all = divided.mean(i);
            expect_near(sum_of_terms(divided, i), all, 1e-12 * (1 + largest(all)), fmt::format("pixel {}", i));
            for (size_t k = 0; k < term_count; ++k)
              largest_fraction = std::max(largest_fraction, divided.term(Term(k), i).y / std::max(all.y, 1e-9));
          }
          EXPECT_GT(largest_fraction, 0.5);
        }
}

TEST(Terms, AFilmOfThemIsResumed) {
  const auto t = make_world(everything(), over_everything, Sky::neutral(), true);
  const std::filesystem::path file = ::testing::TempDir() + "candela_terms_state";
  const Film film = traced(*t, path_settings(2), over_everything, 4, true);
  ASSERT_TRUE(film.save(file, {}));
  const auto loaded = Film::load(file, {}, over_everything.width, over_everything.height, {.terms = true});
  ASSERT_TRUE(loaded) << loaded.error().text();
  for (size_t i = 0; i < film.pixels(); ++i) {
    for (size_t k = 0; k < term_count; ++k) EXPECT_EQ(loaded->term(Term(k), i), film.term(Term(k), i));
    EXPECT_EQ(loaded->shadow(i), film.shadow(i));
  }
  EXPECT_FALSE(Film::load(file, {}, over_everything.width, over_everything.height)) << "a state with terms";
}

}  // namespace candela::reference::test::reference_terms
