// Automatic exposure against sorting in double.
#include "passes/post/exposure.h"

#include "passes_fixture.h"
#include "reference/display.h"

namespace candela::gpu::test {
namespace {

class ExposureTest : public PassTest {
 protected:
  struct Exposed {
    shared::ExposureResult result;
    std::vector<std::byte> bytes;
  };
  Exposed run(const std::vector<glm::vec4>& texels, int width, int height, const AutoExposure& look, int bins,
              float scale = 1) {
    GraphBuilder builder;
    const Buffer source = upload(texels, "texels");
    Exposure pass;
    pass.knobs.bins = bins;
    Exposure::In in{make_image(builder, import(builder, source, "texels"), uint32_t(width), uint32_t(height)),
                    uint32_t(width), uint32_t(height), look, scale};
    const Exposure::Out out = add(builder, pass, in);
    const BufferHandle words = read_words(builder, "exposure", out.exposure, sizeof(shared::ExposureResult));
    const FrameRun frame = run_all(builder);
    const auto report = values_of<shared::ExposureResult>(*frame.readbacks.at(out.report.resource))[0];
    const auto result = values_of<shared::ExposureResult>(*frame.readbacks.at(words.resource))[0];
    EXPECT_EQ(std::memcmp(&report, &result, sizeof report), 0);
    const auto bytes = std::as_bytes(std::span(&result, 1));
    return {result, {bytes.begin(), bytes.end()}};
  }
  static double truth(const std::vector<glm::vec4>& texels, const AutoExposure& look, double scale = 1) {
    std::vector<glm::dvec4> pixels;
    for (const glm::vec4& t : texels) pixels.emplace_back(glm::dvec3(t) * scale, t.w);
    return reference::automatic_ev(pixels, look);
  }
  // Over twelve stops, some of it transparent and some black.
  static std::vector<glm::vec4> picture(int count, uint64_t seed) {
    Rng rng(seed);
    std::vector<glm::vec4> texels;
    for (int i = 0; i < count; ++i) {
      const float light = std::exp2(12 * float(rng.uniform()) - 7), alpha = rng.uniform() < 0.1 ? 0.0f : 1.0f;
      texels.emplace_back(alpha * light * glm::vec3(1, 0.5f, float(rng.uniform())), alpha);
      if (rng.uniform() < 0.05) texels.back() = {0, 0, 0, 1};
    }
    return texels;
  }
};

}  // namespace

// The finer the bins the nearer, at any size and percentiles.
TEST_F(ExposureTest, TendsToTheSortedMean) {
  for (const auto& [width, height] : {std::pair(97, 41), std::pair(64, 16), std::pair(1, 1), std::pair(3, 200)}) {
    const auto texels = picture(width * height, 5);
    for (const AutoExposure& look : {AutoExposure{}, AutoExposure{.low_percent = 0, .high_percent = 100},
                                     AutoExposure{.low_percent = 90, .high_percent = 99, .target = 0.5}}) {
      const double wanted = truth(texels, look);
      double bound = 1.6;
      for (const int bins : {16, 64, 256, 1024, 4096}) {
        EXPECT_NEAR(run(texels, width, height, look, bins).result.ev, wanted, bound)
            << width << "x" << height << " " << bins;
        bound /= 4;
      }
      const auto exact = run(texels, width, height, look, 4096);
      EXPECT_FLOAT_EQ(exact.result.factor, std::exp2(exact.result.ev));
    }
  }
}

TEST_F(ExposureTest, KnowsThePicturesUnits) {
  const auto texels = picture(1000, 9);
  const double one = run(texels, 50, 20, {}, 4096).result.ev, half = run(texels, 50, 20, {}, 4096, 0.5f).result.ev;
  EXPECT_NEAR(half, one + 1, 0.01);
  EXPECT_NEAR(half, truth(texels, {}, 0.5), 0.02);
}

TEST_F(ExposureTest, IsTheSameBytesEachTime) {
  const auto texels = picture(320 * 180, 3);
  const auto first = run(texels, 320, 180, {}, 256).bytes;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(run(texels, 320, 180, {}, 256).bytes, first);
}

TEST_F(ExposureTest, StaysWithinItsLimits) {
  const auto all = [](glm::vec4 texel) { return std::vector<glm::vec4>(256, texel); };
  const auto ev = [&](glm::vec4 texel, const AutoExposure& look = {}) {
    return run(all(texel), 16, 16, look, 256).result;
  };
  EXPECT_EQ(ev({0, 0, 0, 1}).ev, 16.0f) << "black";
  EXPECT_EQ(ev({1e30f, 1e30f, 1e30f, 1}).ev, -16.0f);
  EXPECT_EQ(ev({5, 5, 5, 0}).ev, 0.0f) << "nothing is opaque";
  EXPECT_EQ(ev({5, 5, 5, 0}).pixels, 0u);
  EXPECT_EQ(ev({std::numeric_limits<float>::quiet_NaN(), 1, 1, 1}).pixels, 0u);
  EXPECT_EQ(ev({std::numeric_limits<float>::infinity(), 1, 1, 1}).ev, -16.0f);
  EXPECT_EQ(ev({1, 1, 1, 1}, {.min_ev = -1, .max_ev = 1}).ev, -1.0f);
  // Half transparent light counts as it is shown, undiluted.
  EXPECT_EQ(ev({0.5f, 0.5f, 0.5f, 0.5f}).ev, ev({1, 1, 1, 1}).ev);
}

}  // namespace candela::gpu::test
