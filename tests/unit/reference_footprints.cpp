// Colours as means of their textures over what a sample's part of the pixel sees, against many samples of points.
#include <fmt/format.h>

#include "reference/ray_differential.h"
#include "reference_fixture.h"
#include "testscenes/procedural_textures.h"

namespace candela::reference::test {
namespace {

// Fine noise of high contrast, with alpha of its own.
int add_noise(GltfBuilder& b) {
  const auto png = png_from(64, 64, 4, [&](double u, double v) {
    const double coarse = tiling_noise(u, v, 32, 1) > 0.6 ? 1 : 0.05;
    return glm::dvec4(coarse, tiling_noise(u, v, 16, 2), 1 - coarse, coarse > 0.5 ? 0.9 : 0.2);
  });
  std::vector<uint8_t> bytes(png.size());
  std::memcpy(bytes.data(), png.data(), png.size());
  b.json["images"].push_back({{"bufferView", b.view(bytes)}, {"mimeType", "image/png"}});
  b.json["textures"].push_back({{"source", b.json["images"].size() - 1}});
  return int(b.json["textures"].size()) - 1;
}
// A floor that runs away from the camera: from some pixels a texel to some texels a pixel.
std::unique_ptr<TestWorld> floor_world(const TestCamera& camera, Json material) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", add_noise(b)}};
  const int square = add_square_mesh(b, 8, add_material(b, material));
  b.json["meshes"][size_t(square)]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      b.accessor<float>("VEC2", {0, 2, 2.3, 2, 2, 0, 0, 0.1});
  add_node(b, {{"mesh", square}});
  add_light(b, {{"type", "directional"}, {"intensity", 3}}, {});
  return make_world(b, camera, {}, false, glm::dvec4(0.1, 0.2, 0.3, 1));
}
double relative_error(const Film& a, const Film& truth) {
  double sum = 0;
  for (size_t i = 0; i < a.pixels(); ++i)
    for (int c = 0; c < 3; ++c) sum += square(a.mean(i)[c] - truth.mean(i)[c]) / (square(truth.mean(i)[c]) + 0.01);
  return sum / double(3 * a.pixels());
}

}  // namespace

TEST(Footprints, AMeanIsTheIntegral) {
  DecodedImage image{8, 8, DecodedImage::Format::rgba32f, 4, {}};
  image.pixels.resize(8 * 8 * 16);
  for (int i = 0; i < 64; ++i) {
    const float texel[4] = {float(i * 37 % 11), float(i % 2), float(i / 8), (i % 3) / 2.0f};
    std::memcpy(image.pixels.data() + size_t(i) * 16, texel, 16);
  }
  const Texture texture(std::move(image), false);
  const Sampler sampler;
  const glm::dvec2 uv(0.3, 0.9);
  for (const double size : {1e-6, 0.1, 0.6, 3.0}) {
    const glm::dvec2 sides[] = {{size, 0.3 * size}, {-0.2 * size, 0.7 * size}};
    glm::dvec4 exact(0), premultiplied(0);
    constexpr int fine = 400;
    for (int i = 0; i < fine; ++i)
      for (int j = 0; j < fine; ++j) {
        const glm::dvec4 c =
            texture.sample(uv + ((i + 0.5) / fine - 0.5) * sides[0] + ((j + 0.5) / fine - 0.5) * sides[1], sampler);
        exact += c / double(fine * fine), premultiplied += glm::dvec4(glm::dvec3(c) * c.w, c.w) / double(fine * fine);
      }
    const glm::dvec4 mean = texture.mean(uv, sides, sampler, false), weighed = texture.mean(uv, sides, sampler, true);
    // Texels are 0 to 10: four points each way a texel leave half a hundredth of that.
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(mean[c], exact[c], 0.05) << size << " " << c;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(weighed[c], premultiplied[c] / premultiplied.w, 0.05) << size << " " << c;
    EXPECT_NEAR(weighed.w, premultiplied.w, 0.01);
  }
  const glm::dvec2 endless_sides[] = {{1e30, 0}, {0, std::numeric_limits<double>::infinity()}};
  for (int c = 0; c < 4; ++c) EXPECT_TRUE(std::isfinite(texture.mean(uv, endless_sides, sampler, true)[c]));
}

// Few samples are as near to the truth as many: of plain, blended and seen in both modes. Without it their error is
// many times that.
TEST(Footprints, FewSamplesAreEnough) {
  const TestCamera camera{.eye = {0, -7, 1.5}, .target = {0, -4, 0}, .yfov_deg = 30, .width = 24, .height = 16};
  for (const bool blended : {false, true})
    for (const Mode mode : {Mode::direct, Mode::path}) {
      Json material = diffuse_material(1, 1, 1);
      if (blended) material["alphaMode"] = "BLEND";
      const auto t = floor_world(camera, material);
      TraceSettings settings = centred(mode);
      settings.ambient = Ambient::off;
      if (blended && mode == Mode::path) continue;  // covered by chance, which is not the texture's noise
      settings.sampler = {SamplerKind::uniform, 1024, 0};
      const Film truth = traced(*t, settings, camera, 1024);
      settings.sampler = {SamplerKind::uniform, 4, 0};
      const double without = relative_error(traced(*t, settings, camera, 4), truth);
      settings.footprints = true;
      const double with = relative_error(traced(*t, settings, camera, 4), truth);
      EXPECT_LT(with, 2e-4) << blended << int(mode);
      EXPECT_GT(without, 50 * with) << blended << int(mode);
      // The parts of samples become points.
      settings.sampler = {SamplerKind::uniform, 256, 0};
      const double many = relative_error(traced(*t, settings, camera, 256), truth);
      EXPECT_LT(many, with) << blended << int(mode);
      RecordProperty(fmt::format("relMSE_{}_{}", blended, int(mode)), fmt::format("{} {} {}", without, with, many));
    }
}

// The derivatives of a ray's way are the differences of ways that begin a little aside.
TEST(RayDifferentials, AreTheDifferencesOfRays) {
  const glm::dvec3 plane = glm::normalize(glm::dvec3(0.1, -0.2, 1)), plane2 = glm::normalize(glm::dvec3(-0.3, 0.1, 1));
  const auto normal = [](glm::dvec3 p) {
    return glm::normalize(glm::dvec3(0.3 * p.x + 0.1, 0.2 * p.y - 0.1 * p.x, 1));
  };
  struct End {
    glm::dvec3 place, direction;
  };
  for (const double eta : {1.5, 1 / 1.5, 0.0}) {  // 0: a mirror
    const auto way = [&](double a, double b, RayDifferential* change) {
      glm::dvec3 p(0, 0, 3), d = glm::normalize(glm::dvec3(0.1 + a, 0.2 + b, -1));
      if (change) {
        const double length = glm::length(glm::dvec3(0.1, 0.2, -1));
        for (int i = 0; i < 2; ++i) {
          const glm::dvec3 step(i == 0, i == 1, 0);
          change->direction[i] = (step - d * glm::dot(d, step)) / length;
        }
      }
      const double t = -glm::dot(p, plane) / glm::dot(d, plane);
      if (change) change->go(d, t, plane);
      p += t * d;
      const glm::dvec3 h = normal(p), v = -d;
      if (change) {
        glm::dvec3 turn[2];
        for (int i = 0; i < 2; ++i)
          turn[i] = (normal(p + 1e-5 * change->place[i]) - normal(p - 1e-5 * change->place[i])) / 2e-5;
        if (eta > 0)
          change->refract(v, h, turn, eta);
        else
          change->reflect(v, h, turn);
      }
      if (eta > 0) {
        const glm::dvec3 across = (glm::dot(v, h) * h - v) / eta;
        d = across - std::sqrt(1 - glm::dot(across, across)) * h;
      } else {
        d = 2 * glm::dot(v, h) * h - v;
      }
      const glm::dvec3 from(0, 0, eta > 0 ? -2 : 5);
      const double t2 = glm::dot(from - p, plane2) / glm::dot(d, plane2);
      if (change) change->go(d, t2, plane2);
      return End{p + t2 * d, d};
    };
    RayDifferential change;
    way(0, 0, &change);
    for (int i = 0; i < 2; ++i) {
      constexpr double step = 1e-5;
      const End more = way(i == 0 ? step : 0, i == 1 ? step : 0, nullptr),
                less = way(i == 0 ? -step : 0, i == 1 ? -step : 0, nullptr);
      const glm::dvec3 direction = (more.direction - less.direction) / (2 * step),
                       place = (more.place - less.place) / (2 * step);
      EXPECT_LT(glm::distance(change.direction[i], direction), 1e-7) << eta << i;
      EXPECT_LT(glm::distance(change.place[i], place), 1e-6) << eta << i;
    }
  }
}

}  // namespace candela::reference::test
