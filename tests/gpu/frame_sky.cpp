#include <numbers>

#include "../unit/split_sum_integral.h"
#include "frame_fixture.h"
#include "image/exr.h"
#include "reference/albedo.h"
#include "scene/environment.h"

namespace candela::test {
namespace {

// Linear in the direction, so that bilinear filtering keeps it and every axis has its own value.
glm::dvec3 radiance(glm::dvec3 d) { return {2 + d.x, 2 + d.y, 2 + d.z}; }

std::string write_sky(const std::function<glm::dvec3(glm::dvec3)>& f) {
  FloatImage image;
  image.width = 256;
  image.height = 128;
  for (const char* name : {"R", "G", "B"}) image.channels.push_back({name, ChannelType::float32, {}, {}});
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const glm::dvec3 c = f(equirect_direction((x + 0.5) / image.width, (y + 0.5) / image.height));
      for (int k = 0; k < 3; ++k) image.channels[size_t(k)].f.push_back(float(c[k]));
    }
  const auto bytes = encode_exr(image, ExrCompression::zip, "sky");
  EXPECT_TRUE(bytes) << bytes.error().text();
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  const std::string path = ::testing::TempDir() + "candela_" + info->name() + "_sky.exr";
  std::ofstream(path, std::ios::binary).write(bytes->data(), long(bytes->size()));
  return path;
}

}  // namespace

class FrameSky : public FrameTest {
 protected:
  static constexpr int width = 64, height = 36;
  static glm::dvec3 direction(glm::dvec3 back, double yfov_deg, int x, int y) {
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back)), up = glm::cross(back, right);
    const double tan_y = std::tan(yfov_deg * std::numbers::pi / 360), tan_x = tan_y * width / height;
    return glm::normalize(tan_x * (2 * (x + 0.5) / width - 1) * right - tan_y * (2 * (y + 0.5) / height - 1) * up -
                          back);
  }
};

// Behind an empty scene, in several directions, among them across the seam at -X and near the poles. What is left is
// the image's curvature between texels of 1.4 degrees, (step/2)^2/2 = 8e-5, and half that again by the mip filter.
TEST_F(FrameSky, ShowsItsImageInTheRightDirection) {
  GltfBuilder b = empty_scene();
  add_node(b, {{"name", "nothing"}});
  const std::string sky = write_sky(radiance);
  for (const int samples : {1, 4})
    for (const glm::dvec3 target : {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0.1, 0.02), glm::dvec3(0, 0.3, 1),
                                    glm::dvec3(0.1, -0.2, -1), glm::dvec3(0.3, 1, 0.2)}) {
      Job job = job_for(write(b), width, height, samples);
      job.sky = sky;
      look(job, {5, 6, 7}, glm::dvec3(5, 6, 7) + target, 40);
      const Images images = images_of(job);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const glm::dvec3 wanted = radiance(direction(-glm::normalize(target), 40, x, y));
          const glm::vec4 p = images["beauty"].at<glm::vec4>(x, y);
          for (int c = 0; c < 3; ++c) EXPECT_NEAR(p[c], wanted[c], 2e-3) << x << " " << y;
          EXPECT_EQ(p.w, 1.0f);
          if (HasFailure()) return;
        }
    }
}

// Where a texel covers more than a pixel, the sky is its bilinear image at full detail: no level coarser is mixed in.
TEST_F(FrameSky, ShowsItsTexelsWhereTheyAreLargerThanPixels) {
  constexpr int sky_width = 256, sky_height = 128;
  const auto texel = [](int x, int y) { return double((x * 7 + y * 13 + x * y % 5) % 4) / 4; };
  const std::string sky = write_sky([&](glm::dvec3 d) {
    const int x = int((std::atan2(d.z, d.x) / (2 * std::numbers::pi) + 0.5) * sky_width);
    const int y = int(std::acos(d.y) / std::numbers::pi * sky_height);
    return glm::dvec3(texel(x, y));
  });
  GltfBuilder b = empty_scene();
  add_node(b, {{"name", "nothing"}});
  Job job = job_for(write(b), width, height);
  job.sky = sky;
  look(job, {0, 0, 0}, {1, 0, 0}, 40);  // a pixel of the middle is 0.82 of a texel
  const Images images = images_of(job);
  double sum = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::dvec3 d = direction({-1, 0, 0}, 40, x, y);
      const double u = (std::atan2(d.z, d.x) / (2 * std::numbers::pi) + 0.5) * sky_width - 0.5,
                   v = std::acos(d.y) / std::numbers::pi * sky_height - 0.5;
      const int x0 = int(std::floor(u)), y0 = int(std::floor(v));
      const double fx = u - x0, fy = v - y0;
      const double wanted = (1 - fy) * ((1 - fx) * texel(x0, y0) + fx * texel(x0 + 1, y0)) +
                            fy * ((1 - fx) * texel(x0, y0 + 1) + fx * texel(x0 + 1, y0 + 1));
      sum += std::abs(images["beauty"].at<glm::vec4>(x, y).x - wanted);
    }
  EXPECT_LT(sum / (width * height), 0.005);  // filters have weights of eight bits
}

// A diffuse surface under the sky reflects the mean radiance around its normal: 2 + 2/3 of the normal's component.
TEST_F(FrameSky, LightsADiffuseSurfaceByItsMeanRadiance) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  add_node(b, {{"mesh", add_square_mesh(b, 2, add_material(b, diffuse_material(0.5, 0.25, 1)))},
               {"rotation", {std::sin(0.2), 0, 0, std::cos(0.2)}}});
  Job job = job_for(write(b), width, height);
  job.effects = "none";  // harmonics hold this sky exactly
  job.sky = write_sky(radiance);
  look(job, {0, 0, 3}, {0, 0, 0}, 20);
  const Images images = images_of(job);
  const glm::dvec3 normal(0, -std::sin(0.4), std::cos(0.4)), albedo(0.5, 0.25, 1);
  const glm::dvec3 wanted = albedo * (2.0 + 2.0 / 3 * normal);
  for (const glm::vec4& p : images["beauty"].values<glm::vec4>())
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(p[c], wanted[c], 2e-4 * wanted[c]);
}

// Under a uniform sky a surface gives back the integral of its BRDF, whatever its roughness, metal and angle: one
// square a case, all seen from +Z without perspective. What is left is the table between its nodes.
TEST_F(FrameSky, ReflectsTheIntegralOfTheBrdfUnderAUniformSky) {
  constexpr std::array roughness = {0.0, 0.2, 0.5, 0.8, 1.0};
  constexpr std::array metallic = {0.0, 0.4, 1.0};
  constexpr std::array degrees = {0.0, 35.0, 60.0, 75.0, 84.0};
  constexpr int cell = 15, columns = int(roughness.size() * metallic.size()), rows = int(degrees.size());
  const glm::dvec3 color(0.9, 0.4, 0);
  GltfBuilder b = empty_scene();
  use_materials(b);
  for (int x = 0; x < columns; ++x) {
    Json pbr = base_color(color.x, color.y, color.z);
    pbr["roughnessFactor"] = roughness[size_t(x) % roughness.size()];
    pbr["metallicFactor"] = metallic[size_t(x) / roughness.size()];
    const int mesh = add_square_mesh(b, 0.45f, add_material(b, {{"pbrMetallicRoughness", pbr}}));
    for (int y = 0; y < rows; ++y) {
      const double half = degrees[size_t(y)] * std::numbers::pi / 360;
      add_node(b, {{"mesh", mesh},
                   {"translation", {x - (columns - 1) / 2.0, (rows - 1) / 2.0 - y, 0}},
                   {"rotation", {std::sin(half), 0, 0, std::cos(half)}}});
    }
  }
  b.json["cameras"] = {{{"type", "orthographic"},
                        {"orthographic", {{"xmag", columns / 2.0}, {"ymag", rows / 2.0}, {"znear", 1}, {"zfar", 9}}}}};
  add_node(b, {{"camera", 0}, {"translation", {0, 0, 5}}});
  Job job = job_for(write(b), columns * cell, rows * cell);
  job.effects = "none";  // the squares would hide some of the sky from each other
  job.sky = write_sky([](glm::dvec3) { return glm::dvec3(1); });
  const Images images = images_of(job);
  const GaussRule rule(32);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const double n_v = std::cos(degrees[size_t(y)] * std::numbers::pi / 180);
      const double rough = std::max(roughness[size_t(x) % roughness.size()], 0.045);
      const double metal = metallic[size_t(x) / roughness.size()];
      const SplitSum s = split_sum_integral(rough, n_v, rule);
      const double dielectric = 0.04 * s.scale + s.bias, left = 1 - (0.04 + 0.96 * grazing_integral(n_v, rule));
      const glm::vec4 p = images["beauty"].at<glm::vec4>(x * cell + cell / 2, y * cell + cell / 2);
      for (int c = 0; c < 3; ++c) {
        const double once = metal * (color[c] * s.scale + s.bias) + (1 - metal) * dielectric;
        const double f0 = metal * color[c] + (1 - metal) * 0.04;
        const double gain = reference::specular_gain(glm::dvec3(f0), rough, n_v).x;
        const double exact = once * gain + (1 - metal) * color[c] * left;
        EXPECT_GE(p[c], 0.0f);
        EXPECT_NEAR(p[c], exact, 1.5e-3) << "roughness " << rough << " metallic " << metal << " degrees "
                                         << degrees[size_t(y)] << " channel " << c;
      }
    }
}

// Objects stand before the sky; blended ones over it.
TEST_F(FrameSky, LiesBehindEverything) {
  GltfBuilder b = empty_scene();
  use_materials(b);
  Json glass = unlit_material(1, 0, 0, 0.5);
  glass["alphaMode"] = "BLEND";
  add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, unlit_material(0, 0, 1)))}, {"translation", {-1, 0, 0}}});
  add_node(b, {{"mesh", add_square_mesh(b, 1, add_material(b, glass))}, {"translation", {1, 0, 0}}});
  for (const int samples : {1, 4}) {
    Job job = job_for(write(b), width, height, samples);
    job.sky = write_sky([](glm::dvec3) { return glm::dvec3(0.25, 4, 0.5); });
    look(job, {0, 0, 4}, {0, 0, 0}, 40);
    const Images images = images_of(job);
    const Image& beauty = images["beauty"];
    EXPECT_EQ(beauty.at<glm::vec4>(24, 18), glm::vec4(0, 0, 1, 1));
    EXPECT_EQ(beauty.at<glm::vec4>(40, 18), glm::vec4(0.625, 2, 0.25, 1));
    EXPECT_EQ(beauty.at<glm::vec4>(1, 1), glm::vec4(0.25, 4, 0.5, 1));
  }
}

}  // namespace candela::test
