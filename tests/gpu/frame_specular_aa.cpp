// Highlights of normals that turn within a pixel (surfaces.specular_aa) against many samples a pixel.
#include "textured_square.h"

namespace candela::test {
namespace {

class SpecularAa : public FrameTest {
 protected:
  // A smooth metal under a lamp: turned by a normal map of that many texels, or a ball of that many pixels.
  static GltfBuilder bumpy() {
    GltfBuilder b = empty_scene();
    use_materials(b);
    const auto png = png_from(64, 64, 3, [](double u, double v) {
      const double x = 64 * u, y = 64 * v;
      const glm::dvec3 n(0.3 * std::sin(0.9 * x + 0.3 * y), 0.3 * std::cos(1.1 * y), 1);
      return glm::dvec4(0.5 + 0.5 * glm::normalize(n), 1);
    });
    Json pbr = base_color(0.9, 0.8, 0.7);
    pbr["metallicFactor"] = 1, pbr["roughnessFactor"] = 0.15;
    Json m = {{"pbrMetallicRoughness", pbr}, {"normalTexture", {{"index", add_texture(b, png, linear_mipmap_linear)}}}};
    add_node(b, {{"mesh", add_textured_square(b, add_material(b, m))}, {"scale", {2, 2, 2}}});
    add_light(b, {{"type", "point"}, {"intensity", 30.0}}, {{"translation", {-0.5, 0.6, 3}}});
    add_light(b, {{"type", "directional"}, {"intensity", 3.0}}, {});
    return b;
  }
  static Image beauty(const std::string& file, const char* method, int n) {
    Job job = job_for(file, 40, 40);
    look(job, {0.4, -0.6, 6}, {0, 0, 0}, 36);
    job.effects = "none";
    job.settings = {{"surfaces", "specular_aa", method}, {"supersample", "n", fmt::format("{}", n)}};
    return images_of(job)["beauty"];
  }
  static double relmse(const Image& a, const Image& truth) {
    double sum = 0;
    for (size_t i = 0; i < truth.pixels(); ++i)
      for (int c = 0; c < 3; ++c) {
        const double t = truth.values<glm::vec4>()[i][c], d = double(a.values<glm::vec4>()[i][c]) - t;
        EXPECT_TRUE(std::isfinite(d));
        sum += d * d / (t * t + 0.01) / 3;
      }
    return sum / double(truth.pixels());
  }
};

}  // namespace

// Nearer to the picture of 64 samples a pixel than one sample without it, and to that picture with more samples.
TEST_F(SpecularAa, ComesNearerToManySamples) {
  const std::string file = write(bumpy());
  const Image truth = beauty(file, "off", 8);
  const double off = relmse(beauty(file, "off", 1), truth);
  for (const char* method : {"normals", "maps"}) {
    const double one = relmse(beauty(file, method, 1), truth), two = relmse(beauty(file, method, 4), truth);
    fmt::print("{}: off {:.4f}, on {:.4f}, with 16 samples {:.5f}\n", method, off, one, two);
    EXPECT_LT(one, 0.5 * off) << method;
    EXPECT_LT(two, 0.5 * one) << method;
  }
}

// A plane without a normal map has nothing that turns.
TEST_F(SpecularAa, LeavesPlanesAsTheyAre) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json pbr = base_color(0.9, 0.8, 0.7);
  pbr["metallicFactor"] = 1, pbr["roughnessFactor"] = 0.15;
  add_node(b, {{"mesh", add_square_mesh(b, 2, add_material(b, {{"pbrMetallicRoughness", pbr}}))}});
  add_light(b, {{"type", "point"}, {"intensity", 30.0}}, {{"translation", {-0.5, 0.6, 3}}});
  const std::string file = write(b);
  const Image off = beauty(file, "off", 1);
  for (const char* method : {"normals", "maps"}) EXPECT_LT(relmse(beauty(file, method, 1), off), 1e-9) << method;
}

}  // namespace candela::test
