#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "image/io.h"
#include "metrics/compare.h"
#include "metrics/limits.h"

namespace candela::metrics_layers {
namespace {

constexpr int width = 40, height = 50;  // 2000 pixels: the trimmed 0.1 % are two
constexpr size_t pixels = size_t(width) * size_t(height);

FloatImage flat(float value) {
  FloatImage image{.width = width, .height = height};
  for (const char* name : {"R", "G", "B", "A"})
    image.channels.push_back({name, ChannelType::float32, std::vector<float>(pixels, value), {}});
  return image;
}
void add(FloatImage& image, const char* name, float value) {
  image.channels.push_back({name, ChannelType::float32, std::vector<float>(pixels, value), {}});
}
std::vector<float>& plane(FloatImage& image, std::string_view name) {
  for (Channel& channel : image.channels)
    if (channel.name == name) return channel.f;
  throw std::out_of_range(std::string(name));
}
const CompareOptions whole = {.encoding = Encoding::linear, .layers = true};

TEST(Compare, LargestErrorHasAPlaceAndTrimmingDropsTheWorstPixels) {
  const FloatImage a = flat(1);
  FloatImage b = a;
  for (float& v : plane(b, "R")) v = 1.1f;
  plane(b, "G")[width * 7 + 3] = 101;  // two fireflies are all of relmse
  plane(b, "B")[width * 30 + 39] = 51;
  const Comparison result = compare(a, b, whole);
  EXPECT_EQ(result.max_at.channel, "G");
  EXPECT_EQ(result.max_at.x, 3);
  EXPECT_EQ(result.max_at.y, 7);
  EXPECT_GT(result.metrics.at("relmse"), 1);
  EXPECT_NEAR(result.metrics.at("relmse-trimmed"), 0.01 / 1.01 / 4, 1e-6);
  // 1998 pixels differ by 0.1, two by more: rank 0.999 * 1999 = 1997.001 is one thousandth of the way to the third
  // largest.
  EXPECT_NEAR(result.metrics.at("p50"), 0.1, 1e-6);
  EXPECT_NEAR(result.metrics.at("p99"), 0.1, 1e-6);
  EXPECT_NEAR(result.metrics.at("p99.9"), 0.1 + 0.001 * 49.9, 1e-4);
  EXPECT_EQ(result.metrics.at("max"), 100);
  EXPECT_TRUE(compare(a, a, whole).max_at.channel.empty());
}

TEST(Compare, PercentilesAreOfTheSortedErrors) {
  const FloatImage a = flat(0);
  FloatImage b = a;
  for (size_t i = 0; i < pixels; ++i) plane(b, "B")[(i * 1009) % pixels] = float(i);  // 0 ... 1999, shuffled
  const auto metrics = compare(a, b, whole).metrics;
  EXPECT_NEAR(metrics.at("p50"), 0.5 * 1999, 1e-6);
  EXPECT_NEAR(metrics.at("p90"), 0.9 * 1999, 1e-6);
  EXPECT_NEAR(metrics.at("p99.9"), 0.999 * 1999, 1e-3);
}

TEST(Compare, TrimmedErrorOfHugeRadianceIsANumber) {
  const FloatImage a = flat(0);
  FloatImage b = a;
  for (float& v : plane(b, "R")) v = 1e25f;  // its square is no float
  const Comparison result = compare(a, b, whole);
  EXPECT_NEAR(result.metrics.at("relmse-trimmed") / result.metrics.at("relmse"), 1, 1e-6);
}

TEST(CompareLayers, EachKindHasItsOwnMeaning) {
  FloatImage a = flat(1);
  add(a, "depth.Z", 100);
  for (const char* c : {"normal.X", "normal.Y"}) add(a, c, 0);
  add(a, "normal.Z", 1);
  add(a, "albedo.R", 0.5f);
  a.channels.push_back({"object_id", ChannelType::uint32, {}, std::vector<uint32_t>(pixels, 7)});
  FloatImage b = a;
  plane(b, "depth.Z")[5] = 101;
  plane(b, "depth.Z")[6] = 1e10f;
  plane(b, "normal.X")[width + 2] = 1, plane(b, "normal.Z")[width + 2] = 1;  // 45 degrees, not of unit length
  plane(b, "normal.Z")[9] = 0;
  plane(b, "albedo.R")[4] = 0.75f;
  b.channels.back().u[11] = 8, b.channels.back().u[12] = 9;
  const Comparison result = compare(a, b, whole);
  ASSERT_EQ(result.layers.size(), 4u);
  std::map<std::string, LayerResult> by_name;
  for (const LayerResult& layer : result.layers) by_name[layer.name] = layer;
  const LayerResult &depth = by_name.at("depth"), &normal = by_name.at("normal"), &albedo = by_name.at("albedo"),
                    &ids = by_name.at("object_id");
  EXPECT_NEAR(depth.metrics.at("depth-rel-max"), 0.01, 1e-9);
  EXPECT_NEAR(depth.metrics.at("depth-rel-mean"), 0.01 / (pixels - 1), 1e-9);
  EXPECT_EQ(depth.metrics.at("one-sided"), 1);
  EXPECT_EQ(depth.metrics.at("differing"), 2);
  EXPECT_EQ(depth.max_at.x, 5);
  EXPECT_NEAR(normal.metrics.at("angle-max"), 45, 1e-5);
  EXPECT_EQ(normal.metrics.at("one-sided"), 1);
  EXPECT_EQ(normal.max_at.y, 1);
  EXPECT_EQ(albedo.metrics.at("max"), 0.25);
  EXPECT_EQ(albedo.max_at.channel, "albedo.R");
  EXPECT_EQ(ids.metrics.at("differing"), 2);
  EXPECT_NEAR(ids.metrics.at("differing-share"), 2.0 / pixels, 1e-12);
  EXPECT_EQ(ids.metrics.count("max"), 0u);  // a distance of ids means nothing
  EXPECT_EQ(result.metrics.at("max"), 0);
  const auto json = nlohmann::json::parse(comparison_json(result, {}));
  EXPECT_EQ(json.begin().key(), "layers");  // sorted here; the text has nonfinite first
  EXPECT_EQ(json["layers"][1]["kind"], "depth");
}

TEST(CompareRegions, ALimitHoldsInEachAndPlacesAreOfTheWholeImage) {
  const FloatImage a = flat(0.5f);
  FloatImage b = a;
  plane(b, "R")[width * 20 + 10] = 1.5f;
  CompareOptions options = whole;
  options.regions = {{8, 18, 4, 4}, {0, 0, 5, 5}};
  const Comparison result = compare(a, b, options);
  ASSERT_EQ(result.refusal, "");
  ASSERT_EQ(result.regions.size(), 2u);
  EXPECT_NEAR(result.regions[0].metrics.at("mae"), 1.0 / (16 * 4), 1e-9);
  EXPECT_EQ(result.regions[0].max_at.x, 10);
  EXPECT_EQ(result.regions[0].max_at.y, 20);
  EXPECT_GT(result.regions[0].metrics.at("flip"), result.metrics.at("flip"));
  EXPECT_EQ(result.regions[1].metrics.at("differing"), 0);
  const std::vector<Limit> limits = {{"mae", 0.001}};
  const auto verdicts = judge_limits(result, limits);
  ASSERT_EQ(verdicts.size(), 3u);
  EXPECT_TRUE(verdicts[0].pass);
  EXPECT_FALSE(verdicts[1].pass);
  EXPECT_EQ(verdicts[1].region, "8,18,4,4");
  EXPECT_TRUE(verdicts[2].pass);
  options.regions = {{38, 0, 3, 3}};
  EXPECT_NE(compare(a, b, options).refusal.find("38,0,3,3"), std::string::npos);
  for (const char* bad : {"", "1,2,3", "1,2,3,0", "-1,2,3,4", "1,2,3,x", "1,2,3,4,5"})
    EXPECT_FALSE(parse_region(bad)) << bad;
}

FloatImage with_variance(FloatImage image, float variance) {
  for (const char* c : {"variance.R", "variance.G", "variance.B"}) add(image, c, variance);
  return image;
}

TEST(CompareNoise, FloorIsWhatThePerfectImageWouldMeasure) {
  // The reference is the truth with errors of +-0.1: exactly what its variance of 0.01 says.
  const FloatImage truth = flat(1);
  FloatImage noisy = with_variance(truth, 0.01f);
  for (const char* c : {"R", "G", "B"})
    for (size_t i = 0; i < pixels; ++i) plane(noisy, c)[i] += i % 2 ? 0.1f : -0.1f;
  const Comparison result = compare(noisy, truth, whole);
  ASSERT_EQ(result.refusal, "");
  ASSERT_TRUE(result.noise);
  EXPECT_NEAR(result.noise->rmse, result.metrics.at("rmse"), 1e-7);
  EXPECT_NEAR(result.noise->relmse, result.metrics.at("relmse"), 1e-7);
  FloatImage other = truth;
  for (float& v : plane(other, "G")) v = 1.3f;
  EXPECT_TRUE(below_noise(compare(noisy, other, whole).metrics, *result.noise).empty());
  EXPECT_EQ(below_noise({{"rmse", 1e-9}, {"relmse", 1e-9}}, *result.noise).size(), 2u);
}

TEST(CompareNoise, HalvesOfTheSamplesSetTheMeanAndOneSampleSaysNothing) {
  FloatImage noisy = with_variance(flat(1), 0.04f);
  EXPECT_NEAR(compare(noisy, flat(1), whole).noise->rmse, std::sqrt(0.04 * 3 / 4), 1e-7);
  noisy.metadata.push_back({.name = "candela:mse", .kind = MetadataEntry::Kind::number, .number = 0.01});
  EXPECT_NEAR(compare(noisy, flat(1), whole).noise->rmse, std::sqrt(0.01 * 3 / 4), 1e-7);
  CompareOptions region = whole;
  region.regions = {{0, 0, 3, 3}};
  EXPECT_NEAR(compare(noisy, flat(1), region).regions[0].noise->rmse, std::sqrt(0.01 * 3 / 4), 1e-7);
  noisy.metadata.push_back({.name = "candela:spp", .kind = MetadataEntry::Kind::number, .number = 1});
  EXPECT_FALSE(compare(noisy, flat(1), whole).noise);
  EXPECT_FALSE(compare(flat(1), flat(1), whole).noise);
}

TEST(CompareFiles, LayersOfOneFileAreARefusalAndNamed) {
  const auto folder = std::filesystem::path(testing::TempDir());
  FloatImage a = with_variance(flat(1), 0), b = flat(1);
  add(a, "depth.Z", 3);
  for (const char* c : {"albedo.R", "albedo.G"}) add(a, c, 1);
  add(b, "albedo.R", 1);  // in part
  b.channels.push_back({"object_id", ChannelType::uint32, {}, std::vector<uint32_t>(pixels, 7)});
  ASSERT_TRUE(write_exr(folder / "layers_a.exr", a));
  ASSERT_TRUE(write_exr(folder / "layers_b.exr", b));
  const auto result = compare_files(folder / "layers_a.exr", folder / "layers_b.exr", {.layers = true});
  ASSERT_TRUE(result);
  EXPECT_NE(result->refusal.find("channels differ"), std::string::npos) << result->refusal;
  EXPECT_EQ(result->only_in_reference, (std::vector<std::string>{"albedo", "depth"}));
  EXPECT_EQ(result->only_in_test, (std::vector<std::string>{"object_id"}));
  EXPECT_TRUE(result->metrics.empty());
}

// Of a Cryptomatte layer with one level here and three there the level that both have is compared; a layer that one
// file has not, and channels that no file calls Cryptomatte's, are refused as before.
TEST(CompareFiles, LevelsOfCryptomatteThatBothHaveAreCompared) {
  const auto folder = std::filesystem::path(testing::TempDir());
  const auto mattes = [](int levels) {
    FloatImage image = flat(1);
    for (int level = 0; level < levels; ++level)
      for (const char channel : {'R', 'G', 'B', 'A'})
        add(image, fmt::format("crypto_object{:02}.{}", level, channel).c_str(), float(level + 1));
    image.metadata.push_back({.name = "cryptomatte/f834d0a/name", .text = "crypto_object"});
    return image;
  };
  const auto compared = [&](const FloatImage& a, const FloatImage& b) {
    EXPECT_TRUE(write_exr(folder / "levels_a.exr", a) && write_exr(folder / "levels_b.exr", b));
    auto result = compare_files(folder / "levels_a.exr", folder / "levels_b.exr", {.layers = true});
    EXPECT_TRUE(result);
    return result ? *result : Comparison{};
  };
  for (const bool more_in_test : {true, false}) {
    FloatImage one = mattes(1);
    plane(one, "crypto_object00.R")[5] = 7;
    const Comparison result = more_in_test ? compared(one, mattes(3)) : compared(mattes(3), one);
    EXPECT_EQ(result.refusal, "");
    ASSERT_EQ(result.layers.size(), 1u);
    EXPECT_EQ(result.layers[0].name, "crypto_object00");
    EXPECT_EQ(result.metrics.at("differing"), 1);
    ASSERT_EQ(result.shared_levels.size(), 1u);
    EXPECT_EQ(result.shared_levels[0].reference, more_in_test ? 1 : 3);
    EXPECT_EQ(result.shared_levels[0].shared(), 1);
    EXPECT_TRUE(result.only_in_reference.empty() && result.only_in_test.empty());
  }
  EXPECT_TRUE(compared(mattes(2), mattes(2)).shared_levels.empty());
  EXPECT_EQ(compared(mattes(2), mattes(0)).only_in_reference,
            (std::vector<std::string>{"crypto_object00", "crypto_object01"}));
  FloatImage plain = mattes(2);
  plain.metadata.clear();
  EXPECT_NE(compared(plain, mattes(1)).refusal, "");
}

TEST(Compare, NonFinitePixelsAreCountedFirst) {
  FloatImage a = flat(1), b = flat(1);
  plane(b, "R")[4] = std::nanf(""), plane(b, "G")[4] = INFINITY, plane(b, "G")[9] = INFINITY;
  const Comparison result = compare(a, b, whole);
  EXPECT_EQ(result.nonfinite_reference, 0u);
  EXPECT_EQ(result.nonfinite_test, 2u);
  EXPECT_NE(result.refusal, "");
  EXPECT_TRUE(comparison_json(result, {}).starts_with("{\n  \"nonfinite\""));
}

}  // namespace
}  // namespace candela::metrics_layers
