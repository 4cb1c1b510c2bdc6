#define GLM_ENABLE_EXPERIMENTAL
#include <cmath>
#include <glm/gtx/component_wise.hpp>

#include "frame_fixture.h"

namespace candela::test {
namespace {

class Supersampling : public FrameTest {
 protected:
  static Job sampled(const std::string& name, int n) {
    Job job = job_for(scene(name), 48, 27);
    job.settings = {{"supersample", "n", fmt::format("{}", n)}};
    return job;
  }
};

// n x n samples a pixel are the pixels of a picture n times as large: same positions, same footprints.
TEST_F(Supersampling, IsTheMeanOfALargerPicturesPixels) {
  for (const char* name : {"street", "texture-transform", "alpha", "normal-mapped"})
    for (const auto& [n, anisotropy] : {std::pair(2, "1"), std::pair(4, "1"), std::pair(4, "8")}) {
      // lavapipe takes an anisotropic footprint's shape from a quad of pixels, which is n times as wide here: only
      // where it is small against the texture's detail are both the same.
      Job large = job_for(scene(name), 48 * n, 27 * n), small = sampled(name, n);
      for (Job* job : {&large, &small}) job->settings.push_back({"textures", "anisotropy", anisotropy});
      const Image truth = images_of(large)["beauty"], mean = images_of(small)["beauty"];
      double worst = 0, sum = 0;
      for (int y = 0; y < 27; ++y)
        for (int x = 0; x < 48; ++x) {
          glm::dvec4 expected(0);
          for (int s = 0; s < n * n; ++s)
            expected += glm::dvec4(truth.at<glm::vec4>(x * n + s % n, y * n + s / n)) / double(n * n);
          const glm::dvec4 difference = glm::abs(expected - glm::dvec4(mean.at<glm::vec4>(x, y)));
          const double relative = glm::compMax(difference) / (0.05 + glm::compMax(glm::abs(expected)));
          worst = std::max(worst, relative);
          sum += relative;
        }
      // Corners are rounded to parts of a pixel, of another size in both: samples next to an edge may change sides.
      EXPECT_LT(sum / (48 * 27), 2e-3) << name << " " << n;
      EXPECT_LT(worst, 1.5) << name << " " << n;
    }
}

// All techniques shade the same samples.
TEST_F(Supersampling, TechniquesAgree) {
  Job job = sampled("street", 2);
  const Image clustered = images_of(job)["beauty"];
  for (const char* technique : {"forward-plus", "brute-force"}) {
    job.technique = technique;
    EXPECT_EQ(images_of(job)["beauty"], clustered) << technique;
  }
}

// Grids of 2 by 2, 4 by 2 and 4 by 4 rays a pixel come nearer to 8 by 8, each to another picture.
TEST_F(Supersampling, GridsOfRaysTendToTheirEnd) {
  for (const char* technique : {"ray", "hybrid"}) {
    const auto picture = [&](const char* columns, const char* rows) {
      Job job = job_for(scene("alpha"), 48, 27);
      job.technique = technique;
      job.effects = "none";
      job.settings = {{"supersample", "n", columns}, {"supersample", "rows", rows}};
      return images_of(job)["beauty"];
    };
    const Image truth = picture("8", "0");
    std::vector<double> errors;
    for (const auto& [columns, rows] : {std::pair("1", "0"), {"2", "0"}, {"4", "2"}, {"4", "0"}}) {
      const Image image = picture(columns, rows);
      double sum = 0;
      for (int y = 0; y < 27; ++y)
        for (int x = 0; x < 48; ++x) {
          const glm::dvec4 off = glm::dvec4(image.at<glm::vec4>(x, y)) - glm::dvec4(truth.at<glm::vec4>(x, y));
          sum += glm::dot(off, off);
        }
      errors.push_back(std::sqrt(sum / (48 * 27)));
    }
    fmt::print("{}: RMSE of 1, 4, 8, 16 samples {:.4f}\n", technique, fmt::join(errors, " "));
    for (size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i], 0.9 * errors[i - 1]) << technique;
    EXPECT_EQ(picture("2", "2"), picture("2", "0"));
  }
}

// Layers are of the pixel's middle, whatever the number of samples.
TEST_F(Supersampling, LayersStayWhereTheyAre) {
  Job one = sampled("spheres", 1), many = sampled("spheres", 2);
  one.layers = many.layers = {"depth", "normal", "object_id"};
  const Images a = images_of(one), b = images_of(many);
  for (const std::string& layer : one.layers) EXPECT_EQ(a[layer], b[layer]) << layer;
}

}  // namespace
}  // namespace candela::test
