// Light of lamps in the air against the reference's, with traced shadows.
#include "reference_parity.h"
#include "testscenes/make_scene.h"

namespace candela::test {

class ReferenceVolumetric : public ReferenceParity {
 protected:
  static std::vector<glm::dvec3> truth_of(const Job& job) {
    std::vector<glm::dvec3> out;
    auto frame = open_reference(job, 0, {});
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().text());
    if (!frame) return out;
    reference::TraceSettings settings;
    settings.ambient = reference::Ambient::occlusion;
    settings.fog_steps = 256;
    settings.sampler = {reference::SamplerKind::uniform, 1, 0};
    reference::Film film(job.width_px, job.height_px, {.terms = true});
    film.add(reference::Integrator(*(*frame)->world, settings, job.width_px, job.height_px), 1,
             [](double) { return true; });
    for (size_t i = 0; i < film.pixels(); ++i) out.push_back(film.term(reference::Term::volumetric, i));
    return out;
  }
  static double relmse(Job job, const std::vector<KnobSetting>& settings, const std::vector<glm::dvec3>& truth) {
    job.settings.insert(job.settings.end(), settings.begin(), settings.end());
    job.layers = {"volumetric"};
    const Images images = images_of(job);
    double sum = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
      const glm::dvec3 seen(images["volumetric"].at<glm::vec4>(int(i) % job.width_px, int(i) / job.width_px));
      for (int c = 0; c < 3; ++c) sum += std::pow(seen[c] - truth[i][c], 2) / (std::pow(truth[i][c], 2) + 0.01) / 3;
    }
    return sum / double(truth.size());
  }
};

// The cave, by both formulas: the exact end, and each knob towards it.
TEST_F(ReferenceVolumetric, TheCaveUpTheLadders) {
  const std::string path = ::testing::TempDir() + "candela_volumetric_cave.glb";
  ASSERT_TRUE(make_scene("cave", 1, 0, path));
  for (const char* formula : {"extinction", "attenuation"}) {
    Job job = job_for(path, 128, 72);
    job.settings = {{"lights", "floor_lux", "0"}, {"local", "size_px", "2048"}};
    job.look =
        look_file(fmt::format(R"({{"volumetric": {{"tau": 0.04, "anisotropy": 0.2, "formula": "{}"}}}})", formula));
    const std::vector<glm::dvec3> truth = truth_of(job);
    ASSERT_FALSE(truth.empty());
    const auto error = [&](const char* name, const std::vector<KnobSetting>& settings) {
      const double e = relmse(job, settings, truth);
      fmt::print("{} {}: relMSE {:.2e}\n", formula, name, e);
      return e;
    };
    const KnobSetting full{"volumetric", "texel_px", "1"}, many{"volumetric", "samples", "512"},
        raw{"volumetric", "filter", "none"}, even{"volumetric", "bayer", "1"};
    const auto samples = [&](const char* n) { return KnobSetting{"volumetric", "samples", n}; };
    const double exact = error("exact", {full, many, raw, even}), few = error("8 samples", {full, raw, samples("8")}),
                 some = error("50 samples", {full, raw, samples("50")}), half = error("half", {many, raw, even}),
                 usual = error("default", {}), gauss = error("gauss", {{"volumetric", "filter", "gauss"}}),
                 bilateral = error("bilateral", {{"volumetric", "filter", "bilateral"}}),
                 flat = error("nearest, bilinear",
                              {{"volumetric", "depth", "nearest"}, {"volumetric", "upsample", "bilinear"}});
    EXPECT_LT(exact, 2e-4);
    EXPECT_LT(some, few);
    EXPECT_LT(exact, some);
    EXPECT_LT(exact, half);
    EXPECT_LT(half, usual);
    EXPECT_LT(usual, bilateral);
    EXPECT_LT(bilateral, gauss);
    EXPECT_LT(usual, flat);
    EXPECT_LT(usual, 0.01);
  }
}

}  // namespace candela::test
