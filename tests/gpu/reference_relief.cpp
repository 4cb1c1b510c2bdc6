// Reliefs of every technique against the reference, whose rays meet the bilinear heights exactly: which pixels show
// them, at what depth, how they shade, and how they move.
#include "relief_fixture.h"

namespace candela::test::reference_relief {

TEST_F(ReferenceRelief, TheExactEndIsWhereTheReferencesRaysMeetIt) {
  for (const bool silhouettes : {true, false}) {
    // Alone: hardware interpolates what is flat, on an H200 to 3e-5 of its distance.
    const Job job = seen_aslant(write(hilly(deep, silhouettes, false)));
    const Fit fit = fit_of(job, true_depths(job));
    EXPECT_GT(fit.seen, 700u);
    EXPECT_LE(fit.missed, 2u) << "outlines alone";
    EXPECT_LT(fit.rms, 2e-6) << fit.text();
  }
}

// A flat floor deep below: its depth is the texel's value, times more than a float's roundings of the way there.
TEST_F(ReferenceRelief, AFlatFloorLiesWhereItsTexelsSay) {
  for (const int code : {1, 51, 100, 127, 201, 254}) {
    Job job = seen_aslant(write(square_of(plain(code), 10, false, false)));
    job.camera.eye = glm::dvec3(0.1, -0.2, 2), job.camera.target = glm::dvec3(0);
    const std::vector<double> truth = true_depths(job);
    const Fit fit = fit_of(job, truth);
    EXPECT_EQ(fit.missed, 0u);
    EXPECT_LT(fit.rms, 1e-6 * (2 + 10 * code / 255.0))
        << "of " << code << "/255: " << fit.text() << ", of the layer " << fit.mean / 10;
  }
}

TEST_F(ReferenceRelief, StepsAndRefinementsTendToIt) {
  const std::string file = write(hilly(deep, true, true, 32));  // a hill of two texels
  const std::vector<double> truth = true_depths(seen_aslant(file));
  std::vector<Fit> by_steps, by_refinements;
  for (const int steps : {8, 32, 128}) by_steps.push_back(fit_of(seen_aslant(file, steps, 8), truth));
  for (const int refinements : {2, 4, 8}) by_refinements.push_back(fit_of(seen_aslant(file, 32, refinements), truth));
  EXPECT_LT(double(by_steps[1].missed), 0.6 * double(by_steps[0].missed));
  EXPECT_LT(by_steps[2].missed, by_steps[1].missed);
  EXPECT_LE(double(by_steps[2].missed), 0.02 * double(by_steps[2].seen));
  EXPECT_LT(by_refinements[1].rms, 0.6 * by_refinements[0].rms);
  EXPECT_LT(by_refinements[2].rms, by_refinements[1].rms) << "down to what the device's filter rounds";
}

TEST_F(ReferenceRelief, EveryTechniqueShadesItAsTheReferenceDoes) {
  const std::string file = write(hilly(deep));
  for (const char* technique : {"clustered", "visibility", "ray", "deferred-clustered", "deferred-volumes"}) {
    Job job = seen_aslant(file);
    job.technique = technique;
    const Pair pair = rendered(job, 1);
    size_t off = 0, seen = 0;
    for (size_t i = 0; i < pair.gpu.size(); ++i) {
      seen += pair.reference[i].w > 0;
      for (int c = 0; c < 4; ++c) ASSERT_TRUE(std::isfinite(pair.gpu[i][c])) << technique;
      const double most = std::max({pair.reference[i].x, pair.reference[i].y, pair.reference[i].z, 1e-2});
      off += glm::length(glm::dvec3(pair.gpu[i] - pair.reference[i])) > 0.01 * most;
    }
    EXPECT_GT(seen, 700u) << technique;
    EXPECT_LE(double(off), 0.01 * double(seen)) << technique << ": more than outlines and creases of cells";
  }
}

TEST_F(ReferenceRelief, ShadowsOfRaysAreThoseOfTheReference) {
  Job job = seen_aslant(write(hilly(deep)));
  job.settings.push_back({"sun", "mode", "traced"});
  job.settings.push_back({"local", "method", "traced"});
  const Images images = images_of(job);
  const reference::Film film = truth_of(job);
  size_t off = 0, seen = 0, dark = 0;
  for (size_t i = 0; i < film.pixels(); ++i) {
    const glm::dvec3 expected(film.mean(i));
    const glm::vec4 found = images["beauty"].at<glm::vec4>(int(i) % width, int(i) / width);
    seen += film.mean(i).w > 0, dark += film.mean(i).w > 0 && expected.x < 0.05;
    off += glm::length(glm::dvec3(found) - expected) > 0.02 * std::max({expected.x, expected.y, expected.z, 1e-2});
  }
  EXPECT_GT(dark, 10u) << "some of it lies in its own shadow";
  EXPECT_LE(double(off), 0.03 * double(seen));
}

TEST_F(ReferenceRelief, MarchesToLightsTendToTheReferencesShadows) {
  // Joints below a sun that grazes the end of the square by which its light comes in, and a lamp.
  GltfBuilder b = hilly(deep, true, false, 8);
  add_light(b, {{"type", "directional"}, {"intensity", 3.0}}, {{"rotation", {0.0, 0.58, 0.0, 0.8146}}});
  Job job = seen_aslant(write(b));
  job.camera.eye = glm::dvec3(1.9, -0.6, 0.8), job.camera.target = glm::dvec3(0.3, 0, -0.1);
  job.settings.push_back({"sun", "size_px", "1024"});
  job.settings.push_back({"sun", "single_px", "1024"});
  const reference::Film film = truth_of(job);
  const auto off = [&](const char* technique, int steps) {  // of all light
    Job marched = job;
    marched.technique = technique;
    marched.settings.push_back({"relief", "light_steps", std::to_string(steps)});
    const Images images = images_of(marched);
    double sum = 0, all = 0;
    for (size_t i = 0; i < film.pixels(); ++i) {
      const glm::vec4 found = images["beauty"].at<glm::vec4>(int(i) % width, int(i) / width);
      sum += std::abs(double(found.x) - film.mean(i).x), all += film.mean(i).x;
    }
    return sum / all;
  };
  std::vector<double> by_steps;
  for (const int steps : {-1, 4, 16, 64, 0}) by_steps.push_back(off("visibility", steps));
  EXPECT_GT(by_steps[0], 0.04) << "by the map alone: what comes in by the ends is lit";
  EXPECT_LT(by_steps[1], 0.3 * by_steps[0]);
  EXPECT_LT(by_steps[2], 0.5 * by_steps[1]);
  EXPECT_LT(by_steps[3], by_steps[2]);
  EXPECT_LT(by_steps[4], by_steps[3]);
  EXPECT_LT(by_steps[4], 0.004);
  for (const char* technique : {"clustered", "deferred-clustered", "deferred-volumes"})
    EXPECT_LT(off(technique, 0), 0.004) << technique;
}

TEST_F(ReferenceRelief, SamplesTendToWhatSixtyFourAPixelShow) {
  const std::string file = write(hilly(deep, true, true));
  Job job = seen_aslant(file);
  job.effects = "none";
  Job fine = job;
  fine.width_px *= 8, fine.height_px *= 8;
  const Images truth = images_of(fine);
  struct Error {
    double outlines = 0, all = 0;  // of coverage, and of light
  };
  const auto error_of = [&](const char* technique, int samples, int by_sample, int supersample) {
    Job asked = job;
    asked.technique = technique, asked.samples = samples;
    asked.settings.push_back({"relief", "by_sample", std::to_string(by_sample)});
    asked.settings.push_back({"supersample", "n", std::to_string(supersample)});
    const Images images = images_of(asked);
    Error error;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        glm::dvec4 mean(0);
        for (int j = 0; j < 64; ++j) mean += glm::dvec4(truth["beauty"].at<glm::vec4>(8 * x + j % 8, 8 * y + j / 8));
        const glm::dvec4 off = glm::abs(glm::dvec4(images["beauty"].at<glm::vec4>(x, y)) - mean / 64.0);
        error.outlines += off.w / (width * height), error.all += (off.x + off.y + off.z) / (width * height);
      }
    return error;
  };
  for (const char* technique : {"clustered", "visibility", "deferred-clustered"}) {
    const Error one = error_of(technique, 1, 0, 1), middle = error_of(technique, 4, 0, 1);
    const Error by_sample = error_of(technique, 4, 1, 1);
    EXPECT_LT(middle.outlines, 0.7 * one.outlines) << technique;
    EXPECT_LT(by_sample.outlines, 0.6 * middle.outlines) << technique;
    EXPECT_LT(by_sample.all, 0.5 * middle.all) << technique << ": what steps inside the outlines too";
  }
  const Error by_sample = error_of("visibility", 4, 1, 1), finer = error_of("visibility", 1, 0, 4);
  EXPECT_LT(finer.outlines, 0.6 * by_sample.outlines);
  EXPECT_LT(finer.all, 0.6 * by_sample.all);
}

TEST_F(ReferenceRelief, OfDepthZeroIsTheFlatSquareBitForBit) {
  const std::string flat = write(hilly(-1));
  const auto flat_bytes = images_of(seen_aslant(flat));
  const std::string none = write(hilly(0));
  EXPECT_EQ(flat_bytes["beauty"].bytes, images_of(seen_aslant(none))["beauty"].bytes);
}

TEST_F(ReferenceRelief, ASceneWithoutOneHoldsNothingOfIt) {
  const std::string flat = write(hilly(-1));
  const auto few = open(seen_aslant(flat, 8)), many = open(seen_aslant(flat, 0));
  ASSERT_TRUE(few && many);
  const FrameResult a = render(*few), b = render(*many);
  EXPECT_EQ(a.plan_hash, b.plan_hash) << "its knobs do nothing";
}

}  // namespace candela::test::reference_relief
