// Lobes of Khronos materials against quadrature of the sphere: energy, reciprocity, sampling.
#include "reference/lobes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "reference/albedo.h"
#include "reference/bsdf.h"
#include "reference/integrator.h"
#include "reference/sampling.h"
#include "reference/sheen.h"
#include "reference/thin_film.h"

namespace candela::reference::reference_lobes {
namespace {

using std::numbers::pi;

glm::dvec3 direction(double degrees, double longitude = 0) {  // from +Z
  const double t = degrees * pi / 180;
  return {std::sin(t) * std::cos(longitude), std::sin(t) * std::sin(longitude), std::cos(t)};
}
Surface with_lobes(double roughness, double metallic, glm::dvec3 color) {
  Surface s;
  s.normal = s.geometric = {0, 0, 1};
  s.base_color = color;
  s.roughness = roughness, s.metallic = metallic;
  s.lobes.emplace();
  return s;
}
// Without light of its own: what is measured is the layer's.
Surface black(double roughness = 1) {
  Surface s = with_lobes(roughness, 0, glm::dvec3(0));
  s.dielectric_f0 = glm::dvec3(0), s.dielectric_f90 = 0;
  return s;
}

// Of a uniform sky on both sides, and the integral of the density.
struct Energy {
  double light = 0, behind = 0, density = 0;
};
Energy integrated(const Surface& s, glm::dvec3 v, int rows = 240, int columns = 96, bool density = false) {
  Energy out;
  // Polar angles about the mirror direction, which is where narrow lobes are: denser towards it.
  const glm::dvec3 axis = glm::reflect(-v, s.normal);
  glm::dvec3 x, y;
  make_frame(axis, x, y);
  for (int i = 0; i < rows; ++i) {
    const double t = (i + 0.5) / rows, polar = pi * t * t * t,
                 area = 2 * pi / columns * 3 * pi * t * t / rows * std::sin(polar);
    for (int j = 0; j < columns; ++j) {
      const double turn = 2 * pi * (j + 0.5) / columns;
      const glm::dvec3 l = std::sin(polar) * (std::cos(turn) * x + std::sin(turn) * y) + std::cos(polar) * axis;
      const double light = evaluate_bsdf(s, l, v).x * area;
      out.light += light;
      if (density) out.density += bsdf_pdf(s, l, v) * area;
      if (glm::dot(l, s.normal) < 0) out.behind += light;
    }
  }
  return out;
}

struct Sampled {
  double light = 0, behind = 0;
};
Sampled sampled(const Surface& s, glm::dvec3 v, int count = 1 << 14) {
  Sampled out;
  for (int i = 0; i < count; ++i) {
    SampleStream stream({}, 0, 0, uint64_t(i));
    const glm::dvec2 u = stream.next2();
    const auto next = sample_bsdf(s, v, stream.next(), u);
    if (!next) continue;
    EXPECT_NEAR(glm::length(next->l), 1, 1e-9);
    EXPECT_EQ(next->through, next->l.z < 0);
    out.light += next->weight.x / count;
    if (next->through) out.behind += next->weight.x / count;
  }
  return out;
}

using Change = std::function<void(Lobes&)>;
void coat(Lobes& lobes) { lobes.clearcoat = 1, lobes.clearcoat_roughness = 0.3; }
void tilted_coat(Lobes& lobes) {
  lobes.clearcoat = 0.7, lobes.clearcoat_roughness = 0.5;
  lobes.clearcoat_normal = direction(25, 2);
}
void sheen(Lobes& lobes) { lobes.sheen_color = {0.9, 0.5, 0.2}, lobes.sheen_roughness = 0.4; }
void film(Lobes& lobes) { lobes.iridescence = 0.8, lobes.film_ior = 1.6, lobes.film_nm = 420; }
void stretch(Lobes& lobes) { lobes.anisotropy = 0.7, lobes.along = direction(90, 0.5); }
void leaf(Lobes& lobes) { lobes.diffuse_transmission = 0.6, lobes.transmitted_color = {0.8, 0.9, 0.3}; }
void all(Lobes& lobes) { coat(lobes), sheen(lobes), film(lobes), stretch(lobes), leaf(lobes); }
const std::vector<std::pair<const char*, Change>>& stacks() {
  static const std::vector<std::pair<const char*, Change>> list = {
      {"coat", coat},
      {"tilted coat", tilted_coat},
      {"sheen", sheen},
      {"film", film},
      {"stretch", stretch},
      {"leaf", leaf},
      {"coat on sheen", [](Lobes& l) { coat(l), sheen(l); }},
      {"coat on film", [](Lobes& l) { coat(l), film(l), stretch(l); }},
      {"all", all}};
  return list;
}

}  // namespace

TEST(Lobes, OfNothingAreTheBaseBitForBit) {
  for (const double metallic : {0.0, 0.4, 1.0})
    for (const double roughness : {0.0, 0.3, 1.0}) {
      Surface plain = with_lobes(roughness, metallic, {0.8, 0.4, 0.2}), s = plain;
      plain.lobes.reset();
      s.lobes->clearcoat_normal = direction(20), s.lobes->clearcoat_roughness = 0.4, s.lobes->sheen_roughness = 0.5;
      s.lobes->film_nm = 0, s.lobes->iridescence = 1, s.lobes->transmitted_color = {0.5, 0.5, 1};
      for (const double degrees : {0.0, 40.0, 89.0, 120.0})
        for (const glm::dvec3 l : {direction(10, 1), direction(80, 3), direction(100)}) {
          const glm::dvec3 v = direction(degrees, 0.3);
          EXPECT_EQ(evaluate_brdf(s, l, v), evaluate_brdf(plain, l, v));
          EXPECT_EQ(diffuse_brdf(s, l, v), diffuse_brdf(plain, l, v));
        }
    }
}

// The estimate from sampled directions is the integral, on both sides, and the density is one of directions.
TEST(Lobes, SamplingAgreesWithTheIntegral) {
  for (const auto& [name, change] : stacks())
    for (const double metallic : {0.0, 0.6})
      for (const double degrees : {10.0, 45.0, 75.0}) {
        Surface s = with_lobes(0.4, metallic, {0.7, 0.6, 0.5});
        change(*s.lobes);
        const glm::dvec3 v = direction(degrees, 0.7);
        const Energy exact = integrated(s, v, 240, 96, true);
        const Sampled estimate = sampled(s, v);
        const std::string where = fmt::format("{} {} {}", name, metallic, degrees);
        EXPECT_NEAR(estimate.light, exact.light, 0.01 * exact.light) << where;
        EXPECT_NEAR(estimate.behind, exact.behind, 0.01 * exact.light) << where;
        EXPECT_NEAR(exact.density, 1, 0.001) << where;
      }
}

// A layer over a black base reflects what the tables say, and never more than all.
TEST(Lobes, LayersReflectTheirAlbedo) {
  for (const double roughness : {0.0, 0.1, 0.3, 0.6, 1.0})
    for (const double degrees : {0.0, 30.0, 60.0, 80.0, 88.0}) {
      const glm::dvec3 v = direction(degrees, 0.7);
      const std::string where = fmt::format("{} {}", roughness, degrees);
      Surface coated = black();
      coated.lobes->clearcoat = 1, coated.lobes->clearcoat_roughness = roughness;
      const double coat_light = integrated(coated, v, degrees > 85 ? 960 : 240, 192).light;
      EXPECT_NEAR(coat_reflectance(coated, v), coat_light, 0.01 * coat_light) << where;
      EXPECT_LE(coat_light, 1.001) << where;
      Surface cloth = black();
      cloth.lobes->sheen_color = {1, 0.5, 0.2}, cloth.lobes->sheen_roughness = roughness;
      const double sheen_light = integrated(cloth, v, 480).light;
      EXPECT_NEAR(sheen_reflectance(cloth, v).x, sheen_light, 0.01 * sheen_light + 1e-4) << where;
      EXPECT_LE(sheen_light, 1.001) << where;
    }
}

// On a base that keeps within its light, stacks do: white metals, for one bounce, and grey dielectrics.
TEST(Lobes, StacksNeverGainLight) {
  for (const auto& [name, change] : stacks())
    for (const double roughness : {0.0, 0.2, 0.5, 1.0})
      for (const double degrees : {0.0, 40.0, 70.0, 85.0})
        for (const double metallic : {0.0, 1.0}) {
          const glm::dvec3 v = direction(degrees, 0.7);
          Surface s = with_lobes(roughness, metallic, glm::dvec3(metallic > 0 ? 1 : 0.8));
          const double bare = integrated(s, v).light;
          change(*s.lobes);
          const Energy e = integrated(s, v);
          EXPECT_LE(e.light, std::max(bare, 1.0) + 0.001)
              << fmt::format("{} {} {} {}", name, roughness, degrees, metallic);
          EXPECT_GT(e.light, 0);
        }
}

// Facets that are stretched lose light between them as round ones do; their gain brings it back without giving more.
TEST(Lobes, TheGainOfStretchedFacetsKeepsTheFurnace) {
  double sum = 0;
  int count = 0;
  for (const double roughness : {0.0, 0.1, 0.3, 0.6, 1.0})
    for (const double strength : {0.2, 0.5, 0.8, 1.0})
      for (const double degrees : {0.0, 40.0, 70.0, 85.0, 89.0})
        for (const double turn : {0.0, 0.8, pi / 2}) {
          Surface s = with_lobes(roughness, 1, glm::dvec3(1));
          s.lobes->anisotropy = strength;
          const glm::dvec3 v = direction(degrees, turn);
          s.specular_gain = specular_gain(glm::dvec3(1), facets_of(s), v);
          // By the normals that are seen, on a grid: no other way has nodes where lobes are that narrow one way.
          constexpr int nodes = 64;
          double light = 0;
          for (int i = 0; i < nodes; ++i) {
            const double step = pi / 2 / nodes,
                         ring = std::pow(std::sin(step * (i + 1)), 2) - std::pow(std::sin(step * i), 2);
            for (int j = 0; j < nodes; ++j) {
              const glm::dvec3 h =
                  visible_normal(facets_of(s), v, {std::pow(std::sin(step * (i + 0.5)), 2), (j + 0.5) / nodes});
              const glm::dvec3 l = glm::normalize(2 * glm::dot(v, h) * h - v);
              if (!(l.z > 0)) continue;
              const double density = smith_g1(facets_of(s), v) * ggx_d(facets_of(s), h) / (4 * v.z);
              light += ring / nodes * evaluate_brdf(s, l, v).x / density;
            }
          }
          const std::string where = fmt::format("{} {} {} {}", roughness, strength, degrees, turn);
          EXPECT_LE(light, 1.011) << where;
          EXPECT_GE(light, 0.97) << where;
          EXPECT_NEAR(facet_albedo(s, v).scale + facet_albedo(s, v).bias, light / s.specular_gain.x, 0.13) << where;
          sum += light, ++count;
        }
  EXPECT_NEAR(sum / count, 0.998, 0.003);
}

// Facets, film and both diffuse lobes look the same along the same way; so does sheen as long as it needs no scaling.
// The coat goes by the viewer's angle alone.
TEST(Lobes, AreReciprocal) {
  for (const auto& [name, change] : stacks()) {
    if (std::string_view(name).contains("coat") || std::string_view(name) == "all") continue;
    Surface s = with_lobes(0.4, 0.3, {0.8, 0.4, 0.2});
    change(*s.lobes);
    const glm::dvec3 l = direction(35, 1), v = direction(60, 4);
    ASSERT_LT(sheen_albedo(0.4, v.z), 1);
    const glm::dvec3 there = evaluate_brdf(s, l, v) / l.z, back = evaluate_brdf(s, v, l) / v.z;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(there[c], back[c], 1e-12 * there[c]) << name;
  }
  Surface s = with_lobes(0.4, 0.3, {0.8, 0.4, 0.2}), behind = s;
  leaf(*s.lobes), behind.lobes = s.lobes;
  behind.normal = behind.geometric = {0, 0, -1};
  const glm::dvec3 l = direction(140, 2), v = direction(20);
  EXPECT_GT(evaluate_brdf(s, l, v).x, 0);
  EXPECT_NEAR(evaluate_brdf(s, l, v).x / -l.z, evaluate_brdf(behind, v, l).x / v.z, 1e-12);
}

// Lobes on glass: layers over a sheet or a body, films and stretched facets that light goes through, diffuse light that
// goes into a body and out of it.
TEST(Lobes, OnGlassAreSampledAsTheyAreEvaluated) {
  for (const auto& [name, change] : stacks())
    for (const bool body : {false, true})
      for (const double roughness : {0.0, 0.5}) {
        Glass glass;
        glass.body = body;
        Surface s = with_lobes(roughness, 0.2, {0.7, 0.6, 0.5});
        s.glass = &glass, s.eta = 1.5, s.transmission = 0.5;
        change(*s.lobes);
        if (is_stretched(s)) s.roughness = std::max(roughness, 0.4);  // the nodes are about reflections alone
        const glm::dvec3 v = direction(40, 0.7);
        const Energy exact = integrated(s, v, 240, 96, true);
        double light = 0, behind = 0, made = 0, mirrored = 0;
        constexpr int count = 1 << 14;
        for (int i = 0; i < count; ++i) {
          SampleStream stream({}, 0, 0, uint64_t(i));
          const glm::dvec2 u = stream.next2();
          const auto next = sample_bsdf(s, v, stream.next(), u);
          if (!next) continue;
          EXPECT_EQ(next->through, next->l.z < 0);
          if (next->pdf > 0) {
            light += next->weight.x / count, made += 1.0 / count;
            if (next->through) behind += next->weight.x / count;
          } else {
            mirrored += next->weight.x * (next->through && body ? s.eta * s.eta : 1.0) / count;
          }
        }
        const std::string where = fmt::format("{} {} {}", name, body, roughness);
        EXPECT_NEAR(light, exact.light, 0.01) << where;
        EXPECT_NEAR(behind, exact.behind, 0.01) << where;
        EXPECT_LE(made, exact.density + 0.01) << where;
        // In a furnace the body's inside is brighter by the square of its index.
        EXPECT_LE(exact.light + exact.behind * (body ? s.eta * s.eta - 1 : 0) + mirrored, 1.001) << where;
      }
}

// A window under layers lets through what they leave.
TEST(Lobes, LayersDarkenWindows) {
  Glass glass;
  Surface s = with_lobes(0, 0, glm::dvec3(1));
  s.glass = &glass, s.eta = 1.5, s.transmission = 1;
  const glm::dvec3 v = direction(50);
  const glm::dvec3 bare = straight_share(s, v);
  coat(*s.lobes), sheen(*s.lobes);
  const glm::dvec3 layered = straight_share(s, v);
  EXPECT_NEAR(layered.x, bare.x * share_under(s, v), 1e-12);
  EXPECT_LT(layered.x, 0.95 * bare.x);
}

// Under a uniform sky the ambient term of the raster techniques is the integral of the lobes: within 1 % that of the
// coat, of diffuse light and of stretched facets; a film's as near as one angle stands for all; under sheen too bright
// by what the sheen takes on the side of the light, which the term does not ask.
TEST(Lobes, TheAmbientTermIsTheirIntegral) {
  AmbientSh sky{};
  sky[0] = glm::vec3(float(1 / 0.28209479177387814));
  for (const auto& [name, change] : stacks())
    for (const double degrees : {0.0, 40.0, 70.0}) {
      Surface s = with_lobes(0.5, 0.3, {0.7, 0.6, 0.5});
      change(*s.lobes);
      const glm::dvec3 v = direction(degrees, 0.7);
      s.specular_gain = specular_gain(glm::dvec3(0.2), facets_of(s), v);
      const HarmonicAmbient lobes = harmonic_ambient(sky, s, v);
      const double exact = integrated(s, v).light, ambient = lobes.diffuse.x + lobes.specular.x + lobes.behind.x;
      const double film = s.lobes->iridescence > 0 ? 0.02 : 0, cloth = s.lobes->sheen_color.x > 0 ? 0.045 : 0;
      EXPECT_LE(ambient, exact + 0.01 + film + cloth) << name << " " << degrees;
      EXPECT_GE(ambient, exact - 0.01 - film) << name << " " << degrees;
      EXPECT_EQ(lobes.behind.x > 0, s.lobes->diffuse_transmission > 0);
    }
}

// How many of independent samples fall into each part of the sphere is what the density says, by Pearson's statistic:
// of opaque stacks, and of the same on rough sheets and bodies of glass.
TEST(Lobes, SampledDirectionsLieAsTheDensitySays) {
  constexpr int rings = 12, sectors = 12, fine = 24, count = 1 << 15;
  constexpr double parts = double(rings) * sectors * fine * fine;
  enum class Kind { opaque, sheet, body };
  for (const auto& [name, change] : stacks())
    for (const Kind kind : {Kind::opaque, Kind::sheet, Kind::body})
      for (const double degrees : {20.0, 70.0}) {
        Glass glass;
        glass.body = kind == Kind::body;
        Surface s = with_lobes(0.5, 0.3, {0.7, 0.6, 0.5});
        if (kind != Kind::opaque) s.glass = &glass, s.eta = 1.5, s.transmission = 0.6;
        change(*s.lobes);
        const glm::dvec3 v = direction(degrees, 0.7);
        std::vector<int> found(rings * sectors);
        for (int i = 0; i < count; ++i) {
          SampleStream stream({}, i, 0, 0);  // a pixel each
          const glm::dvec2 u = stream.next2();
          const auto next = sample_bsdf(s, v, stream.next(), u);
          if (!next) continue;
          const glm::dvec3 l = next->l;
          const int ring = std::clamp(int((l.z + 1) / 2 * rings), 0, rings - 1);
          const int sector = std::clamp(int((std::atan2(l.y, l.x) / (2 * pi) + 0.5) * sectors), 0, sectors - 1);
          ++found[size_t(ring * sectors + sector)];
        }
        double statistic = 0, few_found = 0, few_expected = 0;
        int groups = 0;
        const auto compare = [&](double these, double expected) {
          statistic += (these - expected) * (these - expected) / expected, ++groups;
        };
        for (int ring = 0; ring < rings; ++ring)
          for (int sector = 0; sector < sectors; ++sector) {
            double expected = 0;
            for (int i = 0; i < fine; ++i)
              for (int j = 0; j < fine; ++j) {
                const double z = (ring + (i + 0.5) / fine) / rings * 2 - 1, r = std::sqrt(1 - z * z);
                const double turn = ((sector + (j + 0.5) / fine) / sectors - 0.5) * 2 * pi;
                const glm::dvec3 l(r * std::cos(turn), r * std::sin(turn), z);
                if (is_open(s, l)) expected += bsdf_pdf(s, l, v);
              }
            expected *= count * 4 * pi / parts;
            const int these = found[size_t(ring * sectors + sector)];
            if (expected < 10)
              few_found += these, few_expected += expected;
            else
              compare(these, expected);
          }
        if (few_expected >= 10) compare(few_found, few_expected);
        // Of as many normal variables, by Wilson and Hilferty: beyond this is one test in a million.
        const double dof = groups, cube = 1 - 2 / (9 * dof) + 4.75 * std::sqrt(2 / (9 * dof));
        EXPECT_LT(statistic, dof * cube * cube * cube) << fmt::format("{} {} {}", name, int(kind), degrees);
        EXPECT_GT(groups, 20);
        EXPECT_TRUE(few_expected >= 10 || few_found < 40);
      }
}

TEST(Lobes, ExtremesAreFinite) {
  for (const double roughness : {0.0, 1.0})
    for (const double strength : {0.0, 1.0})
      for (const double ior : {1.0, 3.0, 1e6, 1e30})
        for (const double thickness : {0.0, 0.01, 400.0, 1e9, 1e30})
          for (const double metallic : {0.0, 1.0}) {
            Surface s = with_lobes(roughness, metallic, glm::dvec3(1));
            Lobes& lobes = *s.lobes;
            lobes.anisotropy = strength, lobes.iridescence = 1, lobes.film_ior = ior, lobes.film_nm = thickness;
            lobes.sheen_color = glm::dvec3(strength), lobes.sheen_roughness = roughness;
            lobes.clearcoat = 1, lobes.clearcoat_roughness = roughness, lobes.clearcoat_normal = direction(60);
            lobes.diffuse_transmission = strength;
            for (const glm::dvec3 v : {direction(0), direction(90), direction(89.9999), direction(120), direction(180)})
              for (const glm::dvec3 l :
                   {direction(0), direction(90), -v, v, direction(179.99), direction(89.9999, pi)}) {
                const glm::dvec3 f = evaluate_brdf(s, l, v), d = diffuse_brdf(s, l, v);
                const double pdf = brdf_pdf(s, l, v);
                for (int c = 0; c < 3; ++c) {
                  EXPECT_TRUE(std::isfinite(f[c]) && f[c] >= 0);
                  EXPECT_TRUE(std::isfinite(d[c]) && d[c] >= 0);
                }
                EXPECT_TRUE(std::isfinite(pdf) && pdf >= 0);
              }
            for (int i = 0; i < 8; ++i) {
              const glm::dvec3 l =
                  sample_brdf(s, direction(89.99), i / 8.0, {std::fmod(i * 0.618, 1), std::fmod(i * 0.755, 1)});
              EXPECT_NEAR(glm::length(l), 1, 1e-9);
            }
          }
}

// A film of a quarter of a wave takes the reflection of its base away where its index is the root of the base's, half a
// wave leaves it, and one too thick for colours gives none.
TEST(ThinFilm, InterferesAsWavesDo) {
  const double n = 1.3, f0 = std::pow((n * n - 1) / (n * n + 1), 2);
  const auto green = [&](double waves) { return film_reflectance(1, n, waves * 550 / n, glm::dvec3(f0)).y; };
  EXPECT_LT(green(0.25), 0.1 * f0);
  EXPECT_NEAR(green(0.5), f0, 0.1 * f0);
  for (const double cosine : {1.0, 0.6, 0.2}) {
    const glm::dvec3 thick = film_reflectance(cosine, n, 1e9, glm::dvec3(f0));
    EXPECT_NEAR(thick.x, thick.y, 1e-12);
    EXPECT_NEAR(thick.x, thick.z, 1e-12);
  }
  EXPECT_NEAR(film_reflectance(0, n, 400, glm::dvec3(f0)).x, 1, 1e-12);
  // Thinner than an atom the film is air, which the model's Schlick terms still count at grazing angles.
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(film_reflectance(1, n, 1e-9, glm::dvec3(f0))[c], f0, 0.008);
}

// Inside an oblique film a wave's way is as long as its refracted angle says: half a wave of it is where green reflects
// most, a quarter and three quarters are where it reflects least.
TEST(ThinFilm, TheWayInsideIsOfTheRefractedAngle) {
  const double n = 1.3, f0 = std::pow((n * n - 1) / (n * n + 1), 2);
  for (const double cosine : {0.9, 0.6, 0.4}) {
    const double inside = std::sqrt(1 - (1 - cosine * cosine) / (n * n));
    const auto green = [&](double waves) {
      return film_reflectance(cosine, n, waves * 550 / (n * inside), glm::dvec3(f0)).y;
    };
    for (const double off : {-0.25, 0.25}) {
      EXPECT_LT(green(0.5 + off), 0.8 * green(0.5)) << cosine << " " << off;
      EXPECT_LT(green(0.5 + off), green(0.5 + 0.75 * off)) << cosine << " " << off;
      EXPECT_LT(green(0.5 + off), green(0.5 + 1.25 * off)) << cosine << " " << off;
    }
  }
}

// The phase turns where the film's index passes the base's: f0 of 0.04 rounded up or down is the index 1.5 either way.
TEST(ThinFilm, ARoundedBaseHasItsIndex) {
  for (const double nm : {150.0, 400.0, 745.0})
    for (const double cosine : {1.0, 0.7, 0.3}) {
      const auto at = [&](double f0) { return film_reflectance(cosine, 1.5, nm, glm::dvec3(f0)).y; };
      const double exact = at(0.04 + 1e-12);
      EXPECT_NEAR(at(0.04f), exact, 1e-7) << nm << " " << cosine;
      EXPECT_NEAR(at(std::nextafter(0.04f, 1.0f)), exact, 1e-7) << nm << " " << cosine;
    }
}

// The table against a finer integral.
TEST(Sheen, TheTableIsTheIntegral) {
  for (const double roughness : {0.0, 0.08, 0.12, 0.2, 0.45, 0.77, 1.0})
    for (const double n_v : {1e-4, 0.002, 0.03, 0.1, 0.35, 0.7, 1.0}) {
      const double exact = integrate_sheen(roughness, n_v, 400);
      EXPECT_NEAR(sheen_albedo(roughness, n_v), exact, 0.002 * exact + 5e-5) << roughness << " " << n_v;
    }
}

}  // namespace candela::reference::reference_lobes
