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
    const auto png = png_from(256, 256, 3, [](double u, double v) {
      const double x = 256 * u, y = 256 * v;
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
  static Image beauty(const std::string& file, const char* method, int n, double moved = 0) {
    Job job = job_for(file, 40, 40);
    look(job, {0.4 + moved, -0.6, 6}, {moved, 0, 0}, 36);
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

// In a film that moves by tenths of a pixel, the sum of the pixels' variances.
TEST_F(SpecularAa, SparklesLess) {
  const std::string file = write(bumpy());
  const auto sparkling = [&](const char* method) {
    constexpr int frames = 5;
    std::vector<glm::dvec2> sums(size_t(40 * 40));
    for (int f = 0; f < frames; ++f) {
      const Image image = beauty(file, method, 1, 0.01 * f);
      for (size_t i = 0; i < sums.size(); ++i) {
        const double g = image.values<glm::vec4>()[i].y;
        EXPECT_TRUE(std::isfinite(g));
        sums[i] += glm::dvec2(g, g * g) / double(frames);
      }
    }
    double variance = 0;
    for (const glm::dvec2 s : sums) variance += std::max(s.y - s.x * s.x, 0.0);
    return variance;
  };
  const double off = sparkling("off");
  for (const char* method : {"normals", "maps"}) {
    const double on = sparkling(method);
    fmt::print("{}: off {:.4f}, on {:.4f}\n", method, off, on);
    EXPECT_LT(on, 0.5 * off) << method;
  }
}

// With more samples a pixel every value tends to the same picture.
TEST_F(SpecularAa, VanishesWithManySamples) {
  const std::string file = write(bumpy());
  const auto changed = [&](const char* method, int n) {
    return relmse(beauty(file, method, n), beauty(file, "off", n));
  };
  for (const char* method : {"normals", "maps"}) {
    const double one = changed(method, 1), more = changed(method, 8);
    fmt::print("{}: {:.4f}, with 64 samples {:.5f}\n", method, one, more);
    EXPECT_LT(more, 0.1 * one) << method;
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
