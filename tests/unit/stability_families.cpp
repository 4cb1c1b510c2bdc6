#include "stability/measure.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <set>

#include "base/files.h"
#include "stability/scenes.h"

namespace candela::test {
namespace {

Beauty picture(const std::vector<glm::vec4>& pixels) {
  Beauty beauty{int(pixels.size()), 1, 16, {}};
  beauty.bytes.resize(pixels.size() * 16);
  std::memcpy(beauty.bytes.data(), pixels.data(), beauty.bytes.size());
  return beauty;
}
constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();

TEST(Stability, HasScenesOfUniqueNames) {
  std::set<std::string> names, families;
  for (const StabilityRecipe& recipe : stability_recipes()) {
    families.insert(recipe.family);
    EXPECT_TRUE(names.insert(recipe.family + "/" + recipe.name).second) << recipe.name;
  }
  EXPECT_GE(names.size(), 400u);
  EXPECT_EQ(families, (std::set<std::string>{"depth",     "worlds",       "lights",       "materials", "lobes",
                                             "glass",     "transparency", "textures",     "geometry",  "animation",
                                             "tone",      "images",       "fog",          "skies",     "sides",
                                             "occlusion", "far-lights",   "deep-shadows", "bodies",    "mirrors",
                                             "metaballs", "relief",       "shutter",      "paths",     "regions"}));
}

TEST(Stability, ScenesFollowFromTheSeed) {
  const auto recipes = stability_recipes();
  const auto moved =
      std::find_if(recipes.begin(), recipes.end(), [](const StabilityRecipe& r) { return r.family == "worlds"; });
  ASSERT_NE(moved, recipes.end());
  const auto file = [&](uint64_t seed) {
    StabilityInput in{Rng(seed)};
    return moved->make(in).file;
  };
  EXPECT_EQ(file(7), file(7));
  EXPECT_NE(file(7), file(8));
}

TEST(Stability, CountsWhatIsNotFiniteAndWhatHalfCannotHold) {
  const PixelCounts counts =
      count_pixels(picture({{1, 2, 3, 1}, {nan, 0, 0, 1}, {0, infinity, 0, 1}, {70000, 65504, -70000, 1}}), 1);
  EXPECT_EQ(counts.nonfinite, 2u);
  EXPECT_EQ(counts.first_x, 1);
  EXPECT_EQ(counts.beyond_half, 2u);
  EXPECT_FALSE(counts.black);
  EXPECT_EQ(count_pixels(picture({{1, 2, 3, 1}, {-5, 4, 0, 9}}), 2).most, 2);
  // The exposure is taken out before the file gets the values.
  EXPECT_EQ(count_pixels(picture({{40000, 0, 0, 1}}), 0.5).beyond_half, 1u);
  EXPECT_EQ(count_pixels(picture({{70000, 0, 0, 1}}), 2).beyond_half, 0u);
  EXPECT_TRUE(count_pixels(picture({{0, 0, 0, 1}}), 1).black);
}

TEST(Stability, CountsWhatEffectsMakeWrong) {
  const Beauty bare = picture({{1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 1}, {1, 1, 1, 1}});
  const Beauty drawn = picture({{0.5f, 1, 1.00005f, 1}, {1, nan, 1, 1}, {1, 1, 1.001f, 1}, {1, -1e-6f, 1, 1}});
  const EffectCounts counts = count_effects(&bare, 1, drawn, 1);
  EXPECT_EQ(counts.nonfinite, 1u);
  EXPECT_EQ(counts.negative, 1u);
  EXPECT_EQ(counts.brighter, 1u);
  EXPECT_EQ(counts.first_x, 1);
  EXPECT_EQ(count_effects(nullptr, 1, drawn, 1).brighter, 0u);
  EXPECT_EQ(count_effects(&bare, 0.5, drawn, 0.5).brighter, 1u) << "the exposures are taken out";
  EXPECT_EQ(count_effects(&bare, 2, drawn, 1).brighter, 4u);
  EXPECT_EQ(count_effects(nullptr, 1, drawn, 1, 1.0).brighter, 1u) << "more than the most that may be";
  EXPECT_EQ(count_effects(&bare, 1, drawn, 1, 0.4).brighter, 4u);
}

TEST(Stability, CountsWhatIsWrongInLayers) {
  const auto layer = [](const std::vector<std::pair<std::string, std::vector<float>>>& channels) {
    FloatImage image{.width = 3, .height = 1};
    for (const auto& [name, values] : channels) image.channels.push_back({name, ChannelType::float32, values, {}});
    return image;
  };
  LayerCounts counts;
  counts.add(layer({{"motion.X", {0, nan, 1e30f}}, {"motion.Y", {infinity, 0, 0}}}));
  EXPECT_EQ(counts.nonfinite, 2u);
  // Of two names and two levels, by object and by material: only the second pixel's objects are too much.
  counts.add(layer({{"crypto_object00.R", {9, 9, 9}}, {"crypto_object00.G", {1, 0.5f, 0.5f}}}));
  counts.add(layer({{"crypto_object01.G", {0, 0.25f, 0.25f}}, {"crypto_object01.A", {0, 0.5f, 0}}}));
  counts.add(layer({{"crypto_material00.G", {1, 1, 1}}}));
  EXPECT_EQ(counts.nonfinite, 2u);
  EXPECT_EQ(counts.overcovered(), 1u);
}

TEST(Stability, MeasuresErrorAgainstWhatAPixelMayShow) {
  const Beauty right = picture({{1, 1, 1, 1}, {2, 2, 2, 1}, {4, 4, 4, 1}, {0, 0, 0, 1}});
  TruePicture truth = picture_truth(right, 1);
  EXPECT_EQ(picture_error(right, 1, truth, 0).max_relative, 0);
  EXPECT_EQ(picture_error(right, 1, truth, 0).energy, 0);

  const TruthError off =
      picture_error(picture({{1, 1, 1, 1}, {2.2f, 2, 2, 1}, {4, 4, 4, 1}, {0, 0, 0, 1}}), 1, truth, 0.05);
  EXPECT_NEAR(off.max_relative, 0.1, 1e-6);
  EXPECT_EQ(off.beyond, 1u);
  EXPECT_EQ(off.worst_x, 1);
  EXPECT_NEAR(off.energy, 0.2 / 21, 1e-6);
  // Between what the pixel shows a hair to either side everything is right, and so is its sum.
  truth.high[1] = glm::dvec4(2.5, 2.5, 2.5, 1);
  EXPECT_EQ(picture_error(picture({{1, 1, 1, 1}, {2.2f, 2, 2, 1}, {4, 4, 4, 1}, {0, 0, 0, 1}}), 1, truth, 0.05).beyond,
            0u);

  // Light where there is none is measured against a hundredth of the median.
  EXPECT_NEAR(
      picture_error(picture({{1, 1, 1, 1}, {2, 2, 2, 1}, {4, 4, 4, 1}, {0.02f, 0, 0, 1}}), 1, truth, 0.05).max_relative,
      1, 1e-6);
  EXPECT_NEAR(picture_error(picture({{1, 1, 1, 1}, {2, 2, 2, 1}, {4, 4, 4, 1}, {0.02f, 0, 0, 1}}), 1, truth, 0.05, 0.5)
                  .max_relative,
              0.04, 1e-6)
      << "or against more, where a scene says so";
  const TruthError broken =
      picture_error(picture({{nan, 1, 1, 1}, {2, 2, 2, 1}, {4, 4, 4, 1}, {0, 0, 0, 1}}), 1, truth, 0.05);
  EXPECT_EQ(broken.max_relative, std::numeric_limits<double>::infinity());
  EXPECT_EQ(broken.beyond, 1u);
  EXPECT_FALSE(std::abs(broken.energy) <= 1e9);
  // Lost light.
  EXPECT_NEAR(picture_error(picture({{1, 1, 1, 1}, {2, 2, 2, 1}, {0, 0, 0, 1}, {0, 0, 0, 1}}), 1, truth, 0.05).energy,
              -4.0 / 7, 1e-6);
}

// What is right of a pixel is as wide as its place is uncertain, and no wider; and light that is lost within the
// pixels' own bounds is found in their sum.
TEST(Stability, ATruePixelReachesAsFarAsCornersAreRounded) {
  const auto recipes = stability_recipes();
  const auto recipe =
      std::find_if(recipes.begin(), recipes.end(), [](const StabilityRecipe& r) { return r.name == "roughness 0"; });
  ASSERT_NE(recipe, recipes.end());
  StabilityInput in{Rng(1)};
  const StabilityScene scene = recipe->make(in);
  Job job = scene.job;
  job.scene = testing::TempDir() + "candela_true_pixel.glb";
  ASSERT_TRUE(write_file_atomically(job.scene, std::span<const std::byte>(scene.file)));
  const auto fine = traced_picture(job, 0, 1.0 / 256), coarse = traced_picture(job, 0, 1.0 / 64);
  std::filesystem::remove(job.scene);
  ASSERT_TRUE(fine && coarse);
  std::vector<double> ratio;
  for (size_t i = 0; i < fine->centre.size(); ++i) {
    for (int c = 0; c < 4; ++c) {
      EXPECT_LE(fine->low[i][c], fine->centre[i][c]);
      EXPECT_GE(fine->high[i][c], fine->centre[i][c]);
    }
    const double narrow = fine->high[i].x - fine->low[i].x, wide = coarse->high[i].x - coarse->low[i].x;
    if (narrow > 1e-3 * fine->centre[i].x) ratio.push_back(wide / narrow);
  }
  ASSERT_GT(ratio.size(), 100u);
  std::nth_element(ratio.begin(), ratio.begin() + long(ratio.size() / 2), ratio.end());
  EXPECT_NEAR(ratio[ratio.size() / 2], 4, 0.1);

  std::vector<glm::vec4> pixels;
  for (const glm::dvec4& v : fine->centre) pixels.push_back(glm::vec4(v));
  Beauty beauty = picture(pixels);
  beauty.width_px = job.width_px, beauty.height_px = job.height_px;
  EXPECT_EQ(picture_error(beauty, 1, *fine, 1e-3).energy_beyond, 0);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = 0.98f * glm::vec4(fine->low[i]);
  std::memcpy(beauty.bytes.data(), pixels.data(), beauty.bytes.size());
  const TruthError darker = picture_error(beauty, 1, *fine, 0.03);
  EXPECT_EQ(darker.beyond, 0u);
  EXPECT_LT(darker.energy_beyond, -0.015);
}

// With what stands in the light's way a closed room is dark but for its own lamp, and the sun only comes in where walls
// of one side are open.
TEST(Stability, ABlockedTruthHasShadows) {
  const auto recipes = stability_recipes();
  const auto light_of = [&](const std::string& name, int blocked_samples) {
    const auto recipe = std::ranges::find(recipes, name, &StabilityRecipe::name);
    EXPECT_NE(recipe, recipes.end()) << name;
    StabilityInput in{Rng(1)};
    const StabilityScene scene = recipe->make(in);
    EXPECT_EQ(scene.blocked_samples, 1);
    Job job = scene.job;
    job.scene = testing::TempDir() + "candela_blocked_truth.glb";
    EXPECT_TRUE(write_file_atomically(job.scene, std::span<const std::byte>(scene.file)));
    job.width_px = 16, job.height_px = 12;
    const auto truth = traced_picture(job, 0, 1.0 / 256, blocked_samples);
    std::filesystem::remove(job.scene);
    double sum = 0;
    if (truth)
      for (const glm::dvec4& v : truth->centre) sum += v.x;
    return sum;
  };
  const double all = light_of("closed room from within, open", 0), open = light_of("closed room from within, open", 1),
               block = light_of("closed room from within, block", 1);
  EXPECT_GT(block, 0);
  EXPECT_GT(open, 1.1 * block);
  EXPECT_GT(all, 1.01 * open);
  EXPECT_EQ(light_of("closed room from within, auto", 1), block);
}

TEST(Stability, MeasuresTheDisplayAgainstTheCurve) {
  Job job;
  job.tonemap = "none";
  const Beauty beauty = picture({{0.25f, 1, 5, 1}});
  DisplayImage display{1, 1, 3, 16, {}};
  const uint16_t codes[] = {35199, 65535, 65535};  // sRGB of 0.25 is 0.537099
  display.pixels.resize(6);
  std::memcpy(display.pixels.data(), codes, 6);
  EXPECT_LT(display_error(display, beauty, 1, job), 2e-5);
  job.exposure_ev = -1;
  EXPECT_GT(display_error(display, beauty, 1, job), 0.1);
}

}  // namespace
}  // namespace candela::test
