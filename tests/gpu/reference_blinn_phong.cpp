// Blinn's lobe on the GPU against the reference: light by light in 32 bits against 64, and ambient light by the same
// model.
#include "reference_parity.h"
#include "textured_square.h"

namespace candela::test {
namespace {

using Materials = std::vector<Json>;

// Exponents from a matte surface to nearly a mirror, and what is diffuse beside.
Materials stated(const std::vector<double>& exponents) {
  Materials all;
  for (const double exponent : exponents)
    for (const double specular : {0.04, 0.5, 1.0}) {
      Json m = {{"pbrMetallicRoughness", base_color(0.8, 0.4, 0.2)}, {"doubleSided", true}};
      m["extensions"]["CANDELA_materials_blinn_phong"] = {{"exponent", exponent},
                                                          {"specularFactor", {specular, 0.5 * specular, specular}}};
      all.push_back(m);
    }
  return all;
}
Materials of_facets() {
  Materials all;
  for (const double roughness : {0.0, 0.25, 0.5, 0.75, 1.0})
    for (const double metallic : {0.0, 0.5, 1.0}) {
      Json pbr = base_color(0.8, 0.4, 0.2);
      pbr["roughnessFactor"] = roughness, pbr["metallicFactor"] = metallic;
      all.push_back({{"pbrMetallicRoughness", pbr}, {"doubleSided", true}});
    }
  return all;
}

class ReferenceBlinnPhong : public ReferenceParity {
 protected:
  static Pair seen(const Materials& materials, bool lamps, glm::dvec3 eye, const char* shading,
                   glm::dvec3 target = glm::dvec3(0), double yfov_deg = 55) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    int i = 0;
    for (const Json& m : materials) {
      add_node(
          b, {{"mesh", add_square_mesh(b, 0.47f, add_material(b, m))}, {"translation", {i % 6 - 2.5, 1.0 - i / 6, 0}}});
      ++i;
    }
    if (lamps) {
      add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {-2, 0.25, 1.75}}});
      add_light(b, {{"type", "directional"}, {"intensity", 2.0}, {"color", {0.2, 1, 0.4}}},
                {{"rotation", {-0.3, 0.2, 0.1, 0.9274}}});
      // Mirrored by the middles of two squares into the first eye.
      add_light(b, {{"type", "point"}, {"intensity", 15.0}}, {{"translation", {-1.3, 0.5, 5}}});
      add_light(b, {{"type", "point"}, {"intensity", 15.0}}, {{"translation", {-1.3, 2.5, 5}}});
      add_light(b, {{"type", "point"}, {"intensity", 15.0}}, {{"translation", {1, 0.5, -1.5}}});
    }
    Job job = job_for(write(b), 96, 64);
    job.shading = shading;
    look(job, eye, target, yfov_deg);
    return rendered(job, 1);
  }
  // bound: relative, of every channel of every pixel that gets some light; fit: absolute, beside it.
  static void expect_equal(const Materials& materials, double bound, bool lamps = true, const char* shading = "pbr",
                           double fit = 0) {
    double worst = 0;
    for (const glm::dvec3 eye : {glm::dvec3(0.3, -0.5, 5), glm::dvec3(5.2, -0.5, 1.4), glm::dvec3(0.5, 0.6, -5)}) {
      const Pair pair = seen(materials, lamps, eye, shading);
      size_t lit = 0, edges = 0;
      for (size_t i = 0; i < pair.gpu.size(); ++i) {
        if (pair.gpu[i].w != pair.reference[i].w) {  // the middle of the pixel is on a square's edge
          ++edges;
          continue;
        }
        for (int c = 0; c < 3; ++c) {
          ASSERT_TRUE(std::isfinite(pair.gpu[i][c])) << "pixel " << i;
          const double expected = pair.reference[i][c];
          if (expected < 1e-3) continue;
          ++lit;
          const double error = std::max(std::abs(pair.gpu[i][c] - expected) - fit, 0.0) / expected;
          worst = std::max(worst, error);
          ASSERT_LE(error, bound) << "seen from " << eye.x << ": pixel " << i % 96 << "," << i / 96 << " is "
                                  << pair.gpu[i][c] << " and should be " << expected;
        }
      }
      EXPECT_GT(lit, 300u);
      EXPECT_LE(edges, 4u);
    }
    fmt::print("worst {:.2e}\n", worst);
  }
};

}  // namespace

TEST_F(ReferenceBlinnPhong, UnderLamps) { expect_equal(stated({0, 1, 8, 32, 500}), 2e-5); }
// A millionth power shows what 32 bits know of the half vector.
TEST_F(ReferenceBlinnPhong, UnderLampsOfHighExponents) { expect_equal(stated({1e4, 1e5, 1e6}), 3e-3); }
// The peaks alone fill the picture, where a half vector is so near the normal that its cosine is one by 32 bits.
TEST_F(ReferenceBlinnPhong, ThePeakOfAHighExponent) {
  for (const double exponent : {1e4, 1e5, 1e6}) {
    const Pair pair = seen(stated({exponent}), true, {0.3, -0.5, 5}, "pbr", {-0.5, 1, 0}, 200 / std::sqrt(exponent));
    double least = 1e30, most = 0, worst = 0;
    for (size_t i = 0; i < pair.gpu.size(); ++i) {
      const double expected = pair.reference[i].x;
      least = std::min(least, expected), most = std::max(most, expected);
      worst = std::max(worst, std::abs(pair.gpu[i].x - expected) / expected);
    }
    EXPECT_GT(most, 2 * least) << exponent;
    EXPECT_LE(worst, 1e-3) << exponent;
  }
}
TEST_F(ReferenceBlinnPhong, OfMaterialsWithFacets) { expect_equal(of_facets(), 3e-3, true, "blinn-phong"); }
// The neutral light's harmonics: albedos by a fit within 0.002, and by a table.
TEST_F(ReferenceBlinnPhong, AmbientLight) {
  expect_equal(stated({0, 1, 8, 32, 500, 1e6}), 1e-3, false, "pbr", 0.002);
  expect_equal(of_facets(), 1e-3, false, "blinn-phong", 0.002);
}
TEST_F(ReferenceBlinnPhong, IsAnotherPictureThanFacets) {
  const Pair facets = seen(of_facets(), true, {0.3, -0.5, 5}, "pbr"),
             lobes = seen(of_facets(), true, {0.3, -0.5, 5}, "blinn-phong");
  size_t other = 0;
  for (size_t i = 0; i < facets.gpu.size(); ++i)
    other += glm::length(facets.gpu[i] - lobes.gpu[i]) > 0.02 * glm::length(lobes.gpu[i]);
  EXPECT_GT(other, facets.gpu.size() / 8);
}

// The map's colour and its A, which is of the exponent: as the material without a map that has these numbers.
TEST_F(ReferenceBlinnPhong, SpecularMapsScaleColourAndExponent) {
  const auto picture = [](bool map) {
    GltfBuilder b = empty_scene();
    use_materials(b);
    Json m = {{"pbrMetallicRoughness", base_color(0.1, 0.1, 0.1)}};
    Json& own = m["extensions"]["CANDELA_materials_blinn_phong"];
    own["exponent"] = map ? 120.0 : 120.0 * 128 / 255;
    own["specularFactor"] = map ? Json{1, 1, 0.5} : Json{1, 0, 0.5};
    const auto texel = [](double, double) { return glm::dvec4(1, 0, 1, 128.0 / 255); };
    if (map) own["specularTexture"] = {{"index", add_texture(b, png_from(1, 1, 4, texel))}};
    add_node(b, {{"mesh", add_textured_square(b, add_material(b, m))}});
    add_light(b, {{"type", "point"}, {"intensity", 20.0}}, {{"translation", {-0.2, 0.25, 1.75}}});
    Job job = job_for(write(b), 48, 48);
    look(job, {0.3, 0.2, 3}, {0, 0, 0}, 40);
    return rendered(job, 1);
  };
  const Pair with = picture(true), without = picture(false);
  for (size_t i = 0; i < with.gpu.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(with.gpu[i][c], without.gpu[i][c], 1e-4 * (1 + without.gpu[i][c])) << i;
      EXPECT_NEAR(with.reference[i][c], without.reference[i][c], 1e-6 * (1 + without.reference[i][c])) << i;
    }
}

}  // namespace candela::test
