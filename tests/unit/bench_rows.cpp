#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "bench/picture.h"
#include "bench/row.h"
#include "bench/scaling.h"

namespace candela::bench_rows {
namespace {

BenchRow row_of(int lights, double ms, const std::string& technique = "brute-force") {
  BenchRow row;
  row.scene = "street", row.scene_content = "content", row.technique = technique, row.quality = "high";
  row.output = "exr", row.lights = row.lights_wanted = lights;
  row.width_px = 64, row.height_px = 32, row.samples = 4;
  row.device = "llvmpipe", row.device_type = "cpu", row.machine = "a processor", row.cores = 2;
  row.frame = {"frame", {ms, ms * 1.01, ms * 0.99, ms}};
  row.gpu = {"gpu", {ms * 0.9, ms * 0.9, ms * 0.9, ms * 0.9}};
  row.passes = {{"shade", {ms * 0.8, ms * 0.8, ms * 0.8, ms * 0.8}}, {"clear", {0.001, 0.001, 0.001, 0.001}}};
  return row;
}

const RowChange* find(const RowComparison& c, const std::string& quantity) {
  for (const RowChange& change : c.changes)
    if (change.quantity == quantity) return &change;
  return nullptr;
}

TEST(CompareRows, ARowAgainstItselfIsTheSame) {
  const auto result = compare_rows({row_of(4, 10)}, {row_of(4, 10)}, {});
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->slower());
  EXPECT_EQ(result->changes.size(), 4u);
}

TEST(CompareRows, SaysWhatBecameSlowerAndFaster) {
  const auto slower = compare_rows({row_of(4, 10)}, {row_of(4, 12)}, {});
  ASSERT_TRUE(slower);
  EXPECT_TRUE(slower->slower());
  EXPECT_EQ(find(*slower, "frame")->judgement.verdict, Verdict::slower);
  EXPECT_EQ(find(*slower, "shade")->judgement.verdict, Verdict::slower);
  const auto faster = compare_rows({row_of(4, 12)}, {row_of(4, 10)}, {});
  ASSERT_TRUE(faster);
  EXPECT_FALSE(faster->slower());
  EXPECT_EQ(find(*faster, "gpu")->judgement.verdict, Verdict::faster);
}

TEST(CompareRows, PassesOfMicrosecondsAreNoFindings) {
  BenchRow after = row_of(4, 10);
  after.passes[1].ms = {0.01, 0.01, 0.01, 0.01};  // ten times, but a thousandth of the frame
  const auto result = compare_rows({row_of(4, 10)}, {after}, {});
  ASSERT_TRUE(result);
  EXPECT_EQ(find(*result, "clear")->judgement.verdict, Verdict::same);
}

TEST(CompareRows, RowsMatchByConfiguration) {
  BenchRow changed = row_of(16, 10);
  changed.scene_content = "other";
  BenchRow set = row_of(4, 10);
  set.settings = "lights.test=aabb";
  const auto result = compare_rows({row_of(4, 10), row_of(16, 10), row_of(64, 10)}, {row_of(4, 10), changed, set}, {});
  ASSERT_TRUE(result);
  ASSERT_EQ(result->only_old.size(), 1u);
  EXPECT_NE(result->only_old[0].find("64 lights"), std::string::npos);
  ASSERT_EQ(result->only_new.size(), 1u);
  EXPECT_NE(result->only_new[0].find("lights.test=aabb"), std::string::npos);
  ASSERT_EQ(result->not_comparable.size(), 1u);
  EXPECT_NE(result->not_comparable[0].find("16 lights"), std::string::npos);
}

TEST(CompareRows, OtherDevicesAndMachinesAreRefused) {
  BenchRow other = row_of(4, 10);
  other.device = "Some GPU", other.device_type = "discrete";
  auto result = compare_rows({row_of(4, 10)}, {other}, {});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::input);
  EXPECT_NE(result.error().message.find("Some GPU"), std::string::npos);
  other = row_of(4, 10);
  other.cores = 64;
  EXPECT_FALSE(compare_rows({row_of(4, 10)}, {other}, {})) << "a CPU device is its processor";
  // A GPU is the same one behind any processor.
  BenchRow gpu = other;
  gpu.device = "Some GPU", gpu.device_type = "discrete";
  other = gpu;
  other.cores = 2;
  EXPECT_TRUE(compare_rows({gpu}, {other}, {}));
}

TEST(CompareRows, APictureThatGotWorseIsSaid) {
  BenchRow after = row_of(4, 10);
  after.picture = {"brute-force", "", 3, 0.5};
  const auto result = compare_rows({row_of(4, 10)}, {after}, {});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->worse_pictures.size(), 1u);
}

TEST(Scaling, OneLineAWayAlongRisingLights) {
  std::vector<BenchRow> rows;
  for (const int n : {4096, 1, 64, 16, 256, 1024, 4}) rows.push_back(row_of(n, 5 + 0.5 * n));
  rows.push_back(row_of(16, 7, "clustered"));
  rows.push_back(row_of(64, 7, "clustered"));
  rows.push_back(row_of(256, 7, "clustered"));
  rows.back().frame.ms.clear();  // not measured
  std::vector<const BenchRow*> pointers;
  for (const BenchRow& row : rows) pointers.push_back(&row);
  const std::vector<Scaling> all = scalings(pointers);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].way, "brute-force");
  EXPECT_EQ(all[0].lights, (std::vector<double>{1, 4, 16, 64, 256, 1024, 4096}));
  EXPECT_EQ(all[0].top.first_x, 64) << "the last factor of 64";
  EXPECT_GT(all[0].top.exponent, 0.9);
  EXPECT_LT(all[0].all.exponent, all[0].top.exponent);
  EXPECT_EQ(all[1].lights.size(), 2u);
  EXPECT_NEAR(all[1].all.exponent, 0, 1e-12);
}

Beauty picture(const std::vector<float>& values) {
  Beauty image{int(values.size() / 4), 1, 16, std::vector<std::byte>(values.size() * 4)};
  std::memcpy(image.bytes.data(), values.data(), image.bytes.size());
  return image;
}

TEST(Picture, DifferenceCountsPixelsByTheirBits) {
  const Beauty a = picture({1, 2, 3, 1, 0, 0, 0, 1, 5, 5, 5, 1});
  EXPECT_EQ(difference(a, a).differing, 0u);
  const PictureDifference d = difference(a, picture({1, 2, 3, 1, 0, 0, -0.0f, 1, 5, 5.5f, 5, 1}));
  EXPECT_EQ(d.differing, 2u) << "-0 is not bit-equal to 0";
  EXPECT_EQ(d.max_difference, 0.5);
  EXPECT_EQ(d.first_x, 1);
  EXPECT_EQ(d.first_y, 0);
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(difference(picture({infinity, 0, 0, 1}), picture({1, 0, 0, 1})).max_difference,
            std::numeric_limits<double>::infinity());
}

TEST(Picture, HalfFloatsAreRead) {
  // 1, 2, -0.5, the smallest subnormal; against 1, 2, -0.5, 0.
  const std::vector<uint16_t> first = {0x3c00, 0x4000, 0xb800, 0x0001}, second = {0x3c00, 0x4000, 0xb801, 0x0000};
  const auto image = [](const std::vector<uint16_t>& halves) {
    Beauty b{1, 1, 8, std::vector<std::byte>(8)};
    std::memcpy(b.bytes.data(), halves.data(), 8);
    return b;
  };
  const PictureDifference d = difference(image(first), image(second));
  EXPECT_EQ(d.differing, 1u);
  EXPECT_NEAR(d.max_difference, 0.5 * std::exp2(-10), 1e-12);
}

class Bytes : public gpu::Readback {
 public:
  explicit Bytes(const std::vector<float>& values) : values_(values) {}
  std::span<const std::byte> bytes() const override { return std::as_bytes(std::span(values_)); }

 private:
  std::vector<float> values_;
};

TEST(Picture, LightListsComeFromTheLayers) {
  FrameResult frame;
  frame.width_px = 4, frame.height_px = 1;
  EXPECT_FALSE(light_lists(frame));
  const auto add = [&](const char* layer, const std::vector<float>& values) {
    const int resource = int(frame.outputs.size());
    frame.outputs.push_back({.layer = layer, .format = VK_FORMAT_R32_SFLOAT, .resource = resource});
    frame.readbacks[resource] = std::make_shared<Bytes>(values);
  };
  add(listed_layer, {0, 10, 10, 20});
  add(wasted_layer, {0, 5, 0, 5});
  add(missed_layer, {0, 0, 2, 0});
  const auto lists = light_lists(frame);
  ASSERT_TRUE(lists);
  EXPECT_EQ(lists->mean, 10);
  EXPECT_EQ(lists->max, 20);
  EXPECT_EQ(lists->waste_fraction, 0.25);
  EXPECT_EQ(lists->missed, 2);
  EXPECT_GT(lists->p95, 15);
}

TEST(Picture, ThumbnailsArePngOfTheMean) {
  DisplayImage image{1000, 500, 3, 8, std::vector<std::byte>(1000 * 500 * 3, std::byte(77))};
  const std::vector<std::byte> png = thumbnail_png(image, 320);
  ASSERT_GT(png.size(), 30u);
  EXPECT_EQ(png[1], std::byte('P'));
  EXPECT_EQ(int(png[18]) * 256 + int(png[19]), 250) << "a fourth of the width";
  EXPECT_TRUE(heatmap_png({}, 0, 0, 320).empty());
  EXPECT_FALSE(heatmap_png({0, 1, 2, 3}, 2, 2, 320).empty());
}

}  // namespace
}  // namespace candela::bench_rows
