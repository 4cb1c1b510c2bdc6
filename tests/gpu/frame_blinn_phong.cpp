// The sky's light on Blinn's lobe, against sums over its texels with the reference's.
#include "frame_sky_fixture.h"
#include "scene/blinn_phong.h"

namespace candela::test {
namespace {

class BlinnPhongOfSky : public SkyTest {
 protected:
  static constexpr std::array<double, columns> exponents = {0, 2, 8, 30, 100, 400};
  static Job job_of(const std::string& sky) {
    Job job = squares(sky, [](int x) {
      Json m = {{"pbrMetallicRoughness", base_color(0.6, 0.4, 0.3)}};
      m["extensions"]["CANDELA_materials_blinn_phong"] = {{"exponent", exponents[size_t(x)]},
                                                          {"specularFactor", {0.7, 0.5, 0.3}}};
      return m;
    });
    return job;
  }
  static double error(const Texels& sky, std::vector<KnobSetting> settings) {
    Job job = job_of(sky.file);
    job.settings = std::move(settings);
    const Images images = images_of(job);
    return relmse_of(images, [&](int x, int y) {
      reference::Surface s;
      s.normal = turned(y) * glm::dvec3(0, 0, 1);
      s.base_color = {0.6, 0.4, 0.3};
      s.dielectric_f0 = {0.7, 0.5, 0.3};
      s.exponent = exponents[size_t(x)];
      s.roughness = roughness_of_exponent(s.exponent);
      return sum_over(sky, s);
    });
  }
};

}  // namespace

// Sampled, the error falls with the number of samples; filtered, it takes slices that are made for facets.
TEST_F(BlinnPhongOfSky, ComesNearTheSumOverTheSky) {
  const Texels sky = sunny();
  const double filtered = error(sky, {{"ibl", "method", "lobe"}});
  fmt::print("split {:.5f}, lobe {:.5f}\n", error(sky, {{"ibl", "method", "split"}}), filtered);
  EXPECT_LT(filtered, 0.01);
  double before = 1;
  for (const char* samples : {"16", "128", "1024"}) {
    const double now = error(sky, {{"ibl", "method", "sampled"}, {"ibl", "pixel_samples", samples}});
    EXPECT_LT(now, before) << samples;
    before = now;
  }
  EXPECT_LT(before, 5e-4);
}
TEST_F(BlinnPhongOfSky, PassesTheFurnace) {
  const Texels white = write_sky("white", [](glm::dvec3) { return glm::dvec3(1); });
  for (const char* method : {"split", "lobe", "sampled"}) EXPECT_LT(error(white, {{"ibl", "method", method}}), 2e-5);
}

}  // namespace candela::test
