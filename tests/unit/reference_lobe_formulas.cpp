// The lobes against the formulas of their extensions' texts, written here a second time, and against the double
// integrals of those.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "reference/bsdf.h"
#include "reference/sampling.h"
#include "reference/sheen.h"
#include "reference/thin_film.h"

namespace candela::reference {
namespace {

using std::numbers::pi;

glm::dvec3 direction(double degrees, double longitude = 0) {  // from +Z
  const double t = degrees * pi / 180;
  return {std::sin(t) * std::cos(longitude), std::sin(t) * std::sin(longitude), std::cos(t)};
}

double power5(double x) { return x * x * x * x * x; }

// KHR_materials_sheen: "Charlie" and its visibility.
double sheen_formula(glm::dvec3 l, glm::dvec3 v, double roughness) {
  const double alpha = roughness * roughness, x = (1 - alpha) * (1 - alpha);
  const auto fit = [&](double cosine) {
    const double a = 21.5473 * (1 - x) + 25.3245 * x, b = 3.82987 * (1 - x) + 3.32435 * x,
                 c = 0.19823 * (1 - x) + 0.16801 * x, d = -1.97760 * (1 - x) - 1.27393 * x,
                 e = -4.32054 * (1 - x) - 4.85967 * x;
    return a / (1 + b * std::pow(cosine, c)) + d * cosine + e;
  };
  const auto lambda = [&](double cosine) {
    return std::exp(cosine < 0.5 ? fit(cosine) : 2 * fit(0.5) - fit(1 - cosine));
  };
  const glm::dvec3 h = glm::normalize(l + v);
  const double sine = std::sqrt(std::max(1 - h.z * h.z, 0.0));
  const double density = (2 + 1 / alpha) * std::pow(sine, 1 / alpha) / (2 * pi);
  return density / (4 * l.z * v.z * (1 + lambda(l.z) + lambda(v.z)));
}

// Appendix B of glTF, with the widths of KHR_materials_anisotropy: along x and along y.
double facets_formula(glm::dvec3 l, glm::dvec3 v, double ax, double ay) {
  const glm::dvec3 h = glm::normalize(l + v);
  const double product = ax * ay;
  const glm::dvec3 f(ay * h.x, ax * h.y, product * h.z);
  const double w = product / glm::dot(f, f), density = product * w * w / pi;
  const double to_v = l.z * glm::length(glm::dvec3(ax * v.x, ay * v.y, v.z)),
               to_l = v.z * glm::length(glm::dvec3(ax * l.x, ay * l.y, l.z));
  return density * 0.5 / (to_v + to_l);
}

// KHR_materials_iridescence.
glm::dvec3 film_formula(double cosine, double ior, double nm, glm::dvec3 f0) {
  const auto at_normal = [](double a, double b) { return (a - b) * (a - b) / ((a + b) * (a + b)); };
  const double sine2 = (1 - cosine * cosine) / (ior * ior);
  if (sine2 > 1) return glm::dvec3(1);
  const double within = std::sqrt(1 - sine2);
  const double r0 = at_normal(ior, 1), r12 = r0 + (1 - r0) * power5(1 - cosine), t = 1 - r12;
  const double path = 2 * ior * nm * within;
  glm::dvec3 sum, order, root, phase;
  for (int i = 0; i < 3; ++i) {
    const double s = std::sqrt(f0[i] + 1e-4 < 0.9999 ? f0[i] + 1e-4 : 0.9999), base = (1 + s) / (1 - s);
    const double r1 = at_normal(base, ior), r23 = r1 + (1 - r1) * power5(1 - within);
    const double both = std::min(std::max(r12 * r23, 1e-5), 0.9999);
    phase[i] = pi + (base < ior ? pi : 0);
    root[i] = std::sqrt(both);
    const double first = t * t * r23 / (1 - both);
    sum[i] = r12 + first, order[i] = first - t;
  }
  // Gaussians fitted to the eye's curves, as functions of 2 pi path / 1 m.
  for (int m = 1; m <= 2; ++m) {
    order *= root;
    const double k = 2 * pi * m * path * 1e-9;
    glm::dvec3 xyz;
    const double values[3] = {5.4856e-13, 4.4201e-13, 5.2481e-13}, places[3] = {1.6810e6, 1.7953e6, 2.2084e6},
                 variances[3] = {4.3278e9, 9.3046e9, 6.6121e9};
    for (int i = 0; i < 3; ++i)
      xyz[i] = values[i] * std::sqrt(2 * pi * variances[i]) * std::cos(places[i] * k + m * phase[i]) *
               std::exp(-k * k * variances[i]);
    xyz.x +=
        9.7470e-14 * std::sqrt(2 * pi * 4.5282e9) * std::cos(2.2399e6 * k + m * phase.x) * std::exp(-4.5282e9 * k * k);
    xyz /= 1.0685e-7;
    sum += 2.0 * order *
           glm::dvec3(3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
                      -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
                      0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z);
  }
  return glm::max(sum, glm::dvec3(0));
}

// Over the upper hemisphere, denser towards the horizon and the mirror's direction.
double integral(const std::function<double(glm::dvec3)>& f, int rows = 300) {
  double sum = 0;
  for (int i = 0; i < rows; ++i) {
    const double t = (i + 0.5) / rows, polar = pi / 2 * (1 - t * t), weight = pi * t / rows * std::sin(polar);
    for (int j = 0; j < rows; ++j) {
      // Longitudes are denser about 0, where the mirror direction is.
      const double u = (j + 0.5) / rows * 2 - 1, turn = pi * u * u * u;
      const glm::dvec3 l(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
      sum += f(l) * weight * 3 * pi * u * u * 2 / rows;
    }
  }
  return sum;
}

Surface with_lobes(double roughness, double metallic, glm::dvec3 color) {
  Surface s;
  s.normal = s.geometric = {0, 0, 1};
  s.base_color = color, s.roughness = roughness, s.metallic = metallic;
  s.lobes.emplace();
  return s;
}

// What samples of the surface see of a white sky: the reference's own importance sampling.
glm::dvec3 sampled(const Surface& s, glm::dvec3 v, int count = 1 << 16) {
  glm::dvec3 sum(0);
  for (int i = 0; i < count; ++i) {
    SampleStream stream({}, 0, 0, uint64_t(i));
    const glm::dvec2 u = stream.next2();
    if (const auto next = sample_bsdf(s, v, stream.next(), u)) sum += next->weight;
  }
  return sum / double(count);
}

}  // namespace

// Everything at once, by the extensions' layering: coat over sheen over a base with film and stretched facets, whose
// diffuse light goes through in part.
TEST(LobeFormulas, TheStackIsTheSpecifications) {
  const glm::dvec3 base(0.8, 0.4, 0.2), cloth(0.5, 0.3, 0.6);
  for (const double metallic : {0.0, 0.35, 1.0})
    for (const double film : {0.0, 0.8}) {
      Surface s = with_lobes(0.5, metallic, base);
      Lobes& lobes = *s.lobes;
      lobes.clearcoat = 0.7, lobes.clearcoat_roughness = 0.4, lobes.clearcoat_normal = direction(15, 1);
      lobes.sheen_color = cloth, lobes.sheen_roughness = 0.6;
      lobes.iridescence = film, lobes.film_ior = 1.6, lobes.film_nm = 420;
      lobes.anisotropy = 0.6;  // along x
      lobes.diffuse_transmission = 0.3, lobes.transmitted_color = {0.2, 0.7, 0.9};
      const double alpha = 0.25, along = alpha + (1 - alpha) * 0.36;
      const auto sheen_scale = [&](double cosine) {
        const glm::dvec3 w(std::sqrt(1 - cosine * cosine), 0, cosine);
        const double albedo = integral([&](glm::dvec3 l) { return sheen_formula(l, w, 0.6) * l.z; });
        EXPECT_LT(albedo, 1);
        return 1 - 0.6 * albedo;
      };
      for (const glm::dvec3 v : {direction(15, 0.4), direction(60, 2)})
        for (const glm::dvec3 l : {direction(35, 3), direction(70, 1), direction(140, 2)}) {
          const bool front = l.z > 0;
          const glm::dvec3 over = front ? l : glm::dvec3(l.x, l.y, -l.z), h = glm::normalize(over + v);
          const double v_h = glm::dot(v, h), grazing = power5(1 - v_h);
          const glm::dvec3 dielectric =
              glm::mix(glm::dvec3(0.04 + 0.96 * grazing), film_formula(v_h, 1.6, 420, glm::dvec3(0.04)), film);
          const glm::dvec3 metal = glm::mix(base + (1.0 - base) * grazing, film_formula(v_h, 1.6, 420, base), film);
          const double facets = facets_formula(over, v, along, alpha);
          const glm::dvec3 diffuse = (front ? base * 0.7 : lobes.transmitted_color * 0.3) / pi;
          glm::dvec3 f = diffuse * (1 - std::max({dielectric.x, dielectric.y, dielectric.z}));
          if (front) f += dielectric * facets;
          f = glm::mix(f, front ? metal * facets : glm::dvec3(0), metallic);
          f *= std::min(sheen_scale(v.z), sheen_scale(std::abs(l.z)));
          if (front) f += cloth * sheen_formula(l, v, 0.6);
          const glm::dvec3 n = lobes.clearcoat_normal;
          const double coat = 0.7 * (0.04 + 0.96 * power5(1 - glm::dot(n, v))), n_l = glm::dot(n, l);
          glm::dvec3 expected = f * (1 - coat) * std::abs(l.z);
          if (n_l > 0) {
            glm::dvec3 x, y;
            make_frame(n, x, y);
            const auto about = [&](glm::dvec3 d) { return glm::dvec3(glm::dot(d, x), glm::dot(d, y), glm::dot(d, n)); };
            expected += coat * facets_formula(about(l), about(v), 0.16, 0.16) * n_l;
          }
          const glm::dvec3 found = evaluate_bsdf(s, l, v);
          for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(found[c], expected[c], 2e-3 * expected[c] + 1e-9)
                << fmt::format("{} {} {} {} {}", metallic, film, v.z, l.z, c);
        }
    }
}

// Each lobe's fraction of a white sky, by its own sampling, is the double integral of its formula within 1 %, and never
// more than there is.
TEST(LobeFormulas, FurnacesAreTheIntegralsOfTheFormulas) {
  for (const double degrees : {5.0, 40.0, 70.0, 85.0})
    for (const double roughness : {0.25, 0.5, 1.0}) {
      const glm::dvec3 v = direction(degrees, pi);  // mirrored towards longitude 0
      const double alpha = roughness * roughness;
      const std::string where = fmt::format("{} {}", degrees, roughness);
      const auto black = [&] {
        Surface s = with_lobes(1, 0, glm::dvec3(0));
        s.dielectric_f0 = glm::dvec3(0), s.dielectric_f90 = 0;
        return s;
      };
      {
        Surface s = black();
        s.lobes->clearcoat = 1, s.lobes->clearcoat_roughness = roughness;
        const double fresnel = 0.04 + 0.96 * power5(1 - v.z);
        const double exact = fresnel * integral([&](glm::dvec3 l) { return facets_formula(l, v, alpha, alpha) * l.z; });
        EXPECT_NEAR(sampled(s, v).x, exact, 0.01 * exact) << "coat " << where;
        EXPECT_LE(exact, 1.001);
      }
      {
        Surface s = black();
        s.lobes->sheen_color = {1, 0.5, 0.25}, s.lobes->sheen_roughness = roughness;
        const double formula = integral([&](glm::dvec3 l) { return sheen_formula(l, v, roughness) * l.z; });
        const double exact = std::min(formula, 1.0);  // what is more is taken back
        const glm::dvec3 found = sampled(s, v);
        EXPECT_NEAR(found.x, exact, 0.01 * exact) << "sheen " << where;
        EXPECT_NEAR(found.z, 0.25 * exact, 0.0025 * exact) << "sheen " << where;
        EXPECT_LE(found.x, 1.001) << "sheen " << where;
      }
      {
        Surface s = with_lobes(roughness, 1, {1, 0.6, 0.3});
        s.lobes->anisotropy = 0.7;
        const double along = alpha + (1 - alpha) * 0.49;
        const auto of = [&](int c) {
          return integral([&](glm::dvec3 l) {
            const double grazing = power5(1 - glm::dot(v, glm::normalize(l + v)));
            return facets_formula(l, v, along, alpha) * (s.base_color[c] + (1 - s.base_color[c]) * grazing) * l.z;
          });
        };
        const glm::dvec3 found = sampled(s, v);
        for (int c = 0; c < 3; ++c) {
          const double exact = of(c);
          EXPECT_NEAR(found[c], exact, 0.01 * exact) << "stretched " << where;
          EXPECT_LE(found[c], 1.001) << "stretched " << where;
        }
      }
      {
        Surface s = with_lobes(roughness, 1, {0.9, 0.6, 0.3});
        s.lobes->iridescence = 1, s.lobes->film_ior = 1.4, s.lobes->film_nm = 350;
        const glm::dvec3 found = sampled(s, v);
        for (int c = 0; c < 3; ++c) {
          const double exact = integral([&](glm::dvec3 l) {
            const glm::dvec3 f = film_formula(glm::dot(v, glm::normalize(l + v)), 1.4, 350, s.base_color);
            return facets_formula(l, v, alpha, alpha) * std::min(f[c], 1.0) * l.z;
          });
          EXPECT_NEAR(found[c], exact, 0.01 * exact) << "film " << where;
          EXPECT_LE(found[c], 1.001) << "film " << where;
        }
      }
      {
        Surface s = black();
        s.base_color = glm::dvec3(0.5);
        s.lobes->diffuse_transmission = 0.4, s.lobes->transmitted_color = {1, 0.5, 0};
        const glm::dvec3 found = sampled(s, v);
        EXPECT_NEAR(found.x, 0.6 * 0.5 + 0.4, 0.01) << "leaf " << where;
        EXPECT_NEAR(found.z, 0.6 * 0.5, 0.005) << "leaf " << where;
      }
    }
}

// The film's reflectance is the extension's at every angle, index, thickness and base.
TEST(LobeFormulas, TheFilmIsTheSpecifications) {
  for (const double cosine : {0.05, 0.3, 0.7, 1.0})
    for (const double ior : {1.0, 1.3, 1.9})
      for (const double nm : {50.0, 300.0, 800.0})
        for (const glm::dvec3 f0 : {glm::dvec3(0.04), glm::dvec3(0.02, 0.3, 0.9)}) {
          const glm::dvec3 found = film_reflectance(cosine, ior, nm, f0),
                           exact = glm::min(film_formula(cosine, ior, nm, f0), glm::dvec3(1));
          for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(found[c], exact[c], 2e-3) << fmt::format("{} {} {} {} {}", cosine, ior, nm, f0[c], c);
        }
}

}  // namespace candela::reference
