// The image of a reflection probe: six views of a cube become an equirectangular sky.
#include "passes/surfaces/probe_knobs.h"
#include "plan/probe_image.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace candela::test {
namespace {

glm::dvec3 radiance(glm::dvec3 d) { return {1 + 0.5 * d.x, 2 + d.y, 3 + d.z * d.x}; }

// What each pixel's middle shows of it, as rasterization projects it.
std::array<ProbeFace, 6> faces_of(const ProbeKnobs& knobs) {
  const ReflectionProbe probe{.position = {5, 6, 7}, .lowest = {0, 0, 0}, .highest = {10, 10, 10}};
  std::array<ProbeFace, 6> faces;
  const int side = probe_job({}, knobs).width_px;
  for (int f = 0; f < 6; ++f) {
    const View view = probe_view(probe, f, knobs);
    EXPECT_EQ(view.position, probe.position);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const glm::dvec2 ndc = 2.0 * (glm::dvec2(x, y) + 0.5) / double(side) - 1.0;
        const glm::dvec4 far = glm::inverse(view.clip_from_relative) * glm::dvec4(ndc, 1, 1);
        const glm::dvec3 c = radiance(glm::normalize(glm::dvec3(far) / far.w));
        for (const double v : {c.x, c.y, c.z, 1.0}) faces[size_t(f)].push_back(float(v));
      }
  }
  return faces;
}

double worst(const DecodedImage& image) {
  double most = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      glm::vec4 t;
      std::memcpy(&t, image.pixels.data() + (size_t(y) * size_t(image.width) + size_t(x)) * 16, 16);
      const glm::dvec3 exact = radiance(equirect_direction((x + 0.5) / image.width, (y + 0.5) / image.height));
      most = std::max(most, glm::length(glm::dvec3(t) - exact));
    }
  return most;
}

}  // namespace

TEST(ProbeImage, ShowsWhatLiesInEachDirection) {
  double before = 1;
  for (const int size : {16, 64, 128}) {
    ProbeKnobs knobs;
    knobs.size_px = size;
    size_t dropped = 1;
    const DecodedImage image = probe_image(faces_of(knobs), knobs, 1, dropped);
    EXPECT_EQ(dropped, 0u);
    EXPECT_EQ(image.width, 4 * size);
    EXPECT_EQ(image.height, 2 * size);
    const double error = worst(image);
    EXPECT_LT(error, 0.3 * before) << size;
    before = error;
  }
  EXPECT_LT(before, 5e-4);
}

TEST(ProbeImage, IsScaledAndFinite) {
  ProbeKnobs knobs;
  knobs.size_px = 16;
  auto faces = faces_of(knobs);
  size_t dropped = 0;
  const DecodedImage twice = probe_image(faces, knobs, 2, dropped);
  glm::vec4 t;
  std::memcpy(&t, twice.pixels.data(), 16);
  EXPECT_NEAR(t.y, 6, 0.05);
  faces[2][4] = std::numeric_limits<float>::quiet_NaN();
  faces[5][9] = std::numeric_limits<float>::infinity();
  faces[0][400] = 3e38f;
  const DecodedImage image = probe_image(faces, knobs, 2, dropped);
  EXPECT_EQ(dropped, 3u);
  for (size_t i = 0; i < image.pixels.size(); i += 4) {
    float v;
    std::memcpy(&v, image.pixels.data() + i, 4);
    ASSERT_TRUE(std::isfinite(v) && v < 100);
  }
}

TEST(ProbeImage, LeavesOutWhatIsNoLightOfSurfacesAndSky) {
  Job job;
  job.layers = {"normal"}, job.background = "1,1,1", job.effects = "bloom,ibl,probes,shadows";
  const Job probe = probe_job(job, {});
  EXPECT_EQ(probe.effects, "ibl,shadows");
  EXPECT_TRUE(probe.layers.empty());
  EXPECT_EQ(probe.background, "transparent");
  EXPECT_EQ(probe.width_px, 258);
  job.effects = "probes";
  EXPECT_EQ(probe_job(job, {}).effects, "none");
  Look look;
  look.fog.emplace(), look.bloom.emplace(), look.volumetric.emplace(), look.reflections.emplace();
  look.probes.emplace_back(), look.sky.blur_deg = 3, look.occlusion.emplace();
  const Look seen = seen_by_probe(look);
  EXPECT_FALSE(seen.fog || seen.bloom || seen.volumetric || seen.reflections);
  EXPECT_TRUE(seen.probes.empty());
  EXPECT_EQ(seen.sky.blur_deg, 0);
  EXPECT_TRUE(seen.occlusion) << "as in every frame of the look";
}

}  // namespace candela::test
