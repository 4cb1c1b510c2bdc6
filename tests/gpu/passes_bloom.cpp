#include <gtest/gtest.h>

#include "passes/post/bloom.h"
#include "passes_fixture.h"
#include "reference/bloom.h"

namespace candela::gpu::test {
namespace {

struct Bloomed {
  std::vector<glm::vec4> color, glow;
  BloomPass::Report report;
};

class BloomTest : public PassTest {
 protected:
  // Noise with a few texels as bright as lamps.
  static std::vector<glm::vec4> picture(int width, int height, uint64_t seed) {
    Rng rng(seed);
    std::vector<glm::vec4> texels(size_t(width) * size_t(height));
    for (glm::vec4& t : texels) {
      const float bright = rng.uniform() < 0.02 ? 100.0f : 1.0f;
      t = {bright * float(rng.uniform()), bright * float(rng.uniform()), bright * float(rng.uniform()), 1};
    }
    return texels;
  }
  Bloomed run_bloom(const std::vector<glm::vec4>& texels, int width, int height, const Bloom& look, int levels,
                    int karis = 0, float exposure = 1) {
    GraphBuilder builder;
    imports.clear();
    const Buffer source = upload(texels, "texels");
    BloomPass pass;
    pass.knobs.levels = levels;
    pass.knobs.karis = karis;
    BloomPass::In in{make_image(builder, import(builder, source, "texels"), uint32_t(width), uint32_t(height)),
                     uint32_t(width), uint32_t(height)};
    in.look = look;
    in.exposure = exposure;
    in.glow_wanted = true;
    const BloomPass::Out out = add(builder, pass, in);
    const uint64_t bytes = texels.size() * sizeof(glm::vec4);
    const BufferHandle color = add_readback(builder, "color", out.color, bytes);
    const BufferHandle glow = add_readback(builder, "glow", out.glow, bytes);
    const FrameRun frame = run_all(builder);
    return {values_of<glm::vec4>(*frame.readbacks.at(color.resource)),
            values_of<glm::vec4>(*frame.readbacks.at(glow.resource)),
            values_of<BloomPass::Report>(*frame.readbacks.at(out.report.resource))[0]};
  }
  static std::vector<glm::dvec3> in_double(const std::vector<glm::vec4>& texels) {
    std::vector<glm::dvec3> out;
    for (const glm::vec4& t : texels) out.emplace_back(t);
    return out;
  }
  // Root of the mean square difference over that of the truth.
  static double relative_error(const std::vector<glm::vec4>& test, const std::vector<glm::dvec3>& truth) {
    double error = 0, scale = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
      const glm::dvec3 d = glm::dvec3(test[i]) - truth[i];
      error += glm::dot(d, d);
      scale += glm::dot(truth[i], truth[i]);
    }
    return std::sqrt(error / std::max(scale, 1e-30));
  }
};

const Bloom five{.strength = 0.5, .weights = {1, 0.5, 0.25, 0.125, 0.0625}};
const Bloom cut{.strength = 1, .threshold = 1.5, .knee = 0.25, .weights = {1, 1, 1}, .keeps = false};

// levels=0 is the convolution, whatever the size.
TEST_F(BloomTest, TheExactEndIsTheConvolution) {
  for (const auto& [width, height] : {std::pair(64, 36), std::pair(33, 17), std::pair(1, 1), std::pair(1, 40)})
    for (const Bloom& look : {five, cut}) {
      const auto texels = picture(width, height, 7);
      for (const float exposure : {1.0f, 0.25f}) {
        const auto glow = reference::bloom_glow(in_double(texels), width, height, look, exposure);
        const auto truth = reference::bloomed(in_double(texels), glow, look, exposure);
        const Bloomed gpu = run_bloom(texels, width, height, look, 0, 0, exposure);
        // Kernels end at four standard deviations, where the truth's end at six.
        EXPECT_LT(relative_error(gpu.glow, glow), 2e-4) << width << "x" << height;
        EXPECT_LT(relative_error(gpu.color, truth), 2e-4) << width << "x" << height;
      }
    }
}

// Every further level of the pyramid comes nearer, and all of them come near.
TEST_F(BloomTest, ThePyramidTendsToIt) {
  constexpr int width = 96, height = 54;
  const auto texels = picture(width, height, 11);
  const auto glow = reference::bloom_glow(in_double(texels), width, height, five, 1);
  std::vector<double> errors;
  for (const int levels : {1, 2, 3, 5})
    errors.push_back(relative_error(run_bloom(texels, width, height, five, levels).glow, glow));
  for (size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i], errors[i - 1]) << i;
  EXPECT_LT(errors.back(), 0.1);
  EXPECT_GT(errors.back(), 1e-4) << "it is a pyramid";
}

// One bright texel anywhere glows in the middle of itself: its centre of mass stays, and its light.
TEST_F(BloomTest, LightStaysWhereItIs) {
  constexpr int width = 101, height = 67;  // odd: halving must not move it
  std::vector<glm::vec4> texels(size_t(width) * height, glm::vec4(0, 0, 0, 1));
  texels[size_t(33) * width + 50] = {1000, 1000, 1000, 1};
  const Bloom look{.strength = 1, .weights = {1, 1}};
  for (const int levels : {0, 2}) {
    const Bloomed gpu = run_bloom(texels, width, height, look, levels);
    glm::dvec2 centre(0);
    double sum = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double v = gpu.color[size_t(y) * width + size_t(x)].x;
        centre += v * glm::dvec2(x, y);
        sum += v;
      }
    centre /= sum;
    EXPECT_NEAR(centre.x, 50, 0.35) << levels;
    EXPECT_NEAR(centre.y, 33, 0.35) << levels;
    EXPECT_NEAR(sum, 1000, 50) << levels;
    EXPECT_NEAR(gpu.report.after / gpu.report.before, sum / 1000, 1e-4) << "what it reports is what it did";
  }
}

TEST_F(BloomTest, AnEvenPictureStaysAsItIs) {
  const std::vector<glm::vec4> texels(size_t(48) * 30, glm::vec4(0.25, 0.5, 2, 1));
  for (const int levels : {0, 1, 4})
    for (const glm::vec4& t : run_bloom(texels, 48, 30, five, levels, 1).color)
      for (int c = 0; c < 4; ++c) EXPECT_NEAR(t[c], texels[0][c], 1e-5 * 2) << levels;
}

// A single bright texel loses light with the Karis average and none without; what is below the threshold never glows.
TEST_F(BloomTest, KarisHoldsSinglePixelsDownAndTheThresholdCuts) {
  std::vector<glm::vec4> texels(size_t(64) * 64, glm::vec4(0.01f, 0.01f, 0.01f, 1));
  texels[64 * 32 + 32] = {5000, 5000, 5000, 1};
  const Bloom look{.strength = 1, .weights = {1}};
  const auto light = [](const Bloomed& b) {
    double s = 0;
    for (const glm::vec4& t : b.glow) s += t.x;
    return s;
  };
  EXPECT_LT(light(run_bloom(texels, 64, 64, look, 4, 1)), 0.5 * light(run_bloom(texels, 64, 64, look, 4, 0)));
  for (const int levels : {0, 4}) {
    const std::vector<glm::vec4> dim(size_t(64) * 64, glm::vec4(1.2f, 1.2f, 1.2f, 1));
    for (const glm::vec4& t : run_bloom(dim, 64, 64, cut, levels).glow) EXPECT_EQ(t.x, 0) << levels;
  }
}

// What is no number is taken for black, and counted once.
TEST_F(BloomTest, NonFinitePixelsDoNotSpread) {
  auto texels = picture(33, 21, 3);
  texels[100].x = std::numeric_limits<float>::infinity();
  texels[101].y = std::numeric_limits<float>::quiet_NaN();
  for (const int levels : {0, 3}) {
    const Bloomed gpu = run_bloom(texels, 33, 21, five, levels);
    EXPECT_EQ(gpu.report.nonfinite, 2u) << levels;
    for (const glm::vec4& t : gpu.glow) EXPECT_TRUE(std::isfinite(t.x + t.y + t.z)) << levels;
    EXPECT_EQ(BloomPass{}.warnings(gpu.report).size(), 1u);
  }
}

}  // namespace
}  // namespace candela::gpu::test
