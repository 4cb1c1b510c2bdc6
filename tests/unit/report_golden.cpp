#include <gtest/gtest.h>

#include "base/files.h"
#include "metrics/difference.h"
#include "report/compare_report.h"
#include "report/golden_report.h"
#include "report/markup.h"

namespace candela {
namespace {

std::string encode(std::string_view text) { return base64(std::as_bytes(std::span(text.data(), text.size()))); }

TEST(Base64, VectorsOfRfc4648) {
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foob"), "Zm9vYg==");
  EXPECT_EQ(encode("\xff\xfe"), "//4=");
  for (const char* text : {"", "f", "fo", "foo", "foob", "\xff\xfe"}) {
    const auto bytes = std::as_bytes(std::span(text, std::strlen(text)));
    EXPECT_EQ(from_base64(encode(text)), std::vector<std::byte>(bytes.begin(), bytes.end()));
  }
  EXPECT_TRUE(from_base64("Zm9v\n").empty());
}

TEST(Markup, IsEscaped) {
  EXPECT_EQ(escape_markup("<a href=\"x\">'&'</a>\x01"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;\xef\xbf\xbd");
}

std::vector<GoldenRow> rows() {
  std::vector<GoldenRow> all(4);
  all[0] = {.name = "a clean", .verdict = "identical", .passed = true, .device_class = "cpu", .time_s = 0.5};
  all[1] = {
      .name = "b blank", .verdict = "identical", .passed = true, .blank = true, .device_class = "cpu", .time_s = 0.25};
  all[2] = {.name = "c warned",
            .verdict = "warned",
            .passed = true,
            .warned = true,
            .message = "7 pixels < all",
            .device_class = "cpu",
            .bounds = {{"FLIP, mean", 0.005, 0.01, 0.004}, {"largest", 0.5, NAN, NAN, 0.25}}};
  all[3] = {.name = "z <broken> & \"quoted\"",
            .verdict = "failed",
            .message = "differs <b>",
            .device_class = "cpu",
            .time_s = 1,
            .metrics = {{"flip", 0.25}}};
  return all;
}

TEST(GoldenHtml, FailuresFirstAndPicturesInside) {
  const auto picture = std::filesystem::path(testing::TempDir()) / "report_picture.png";
  ASSERT_TRUE(write_file_atomically(picture, std::string_view("foob")));
  auto all = rows();
  all[3].golden = picture;
  all[3].actual = "no_such_picture.png";
  all[0].golden = picture;  // of a clean pass: left out
  const std::string html =
      golden_html(all, {.title = "Goldens", .findings = {}, .facts = {{"device", "llvmpipe"}}, .picture = {}});
  const auto at = [&](std::string_view text) { return html.find(text); };
  EXPECT_LT(at("z &lt;broken&gt;"), at("b blank"));
  EXPECT_LT(at("b blank"), at("c warned"));
  EXPECT_LT(at("c warned"), at("a clean"));
  EXPECT_EQ(at("<broken>"), std::string::npos);
  EXPECT_NE(at("blank frame"), std::string::npos);
  EXPECT_NE(at("no_such_picture.png"), std::string::npos);
  EXPECT_NE(at("1 failed, 2 to look at, 1 passed"), std::string::npos);
  EXPECT_NE(at("<tr class=\"above\"><td class=\"text\">FLIP, "
               "mean</td><td>0.005</td><td></td><td>0.004</td><td>0.01</td><td class=\"text\">warns</td></tr>"),
            std::string::npos);
  EXPECT_NE(at("<tr><td class=\"text\">largest</td><td>0.5</td><td>0.25</td><td></td><td></td><td "
               "class=\"text\"></td></tr>"),
            std::string::npos);
  const size_t first = at("data:image/png;base64,Zm9vYg==");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(html.find("data:image/png", first + 1), std::string::npos);
  std::filesystem::remove(picture);
}

// Pictures of 40 x 20 that differ in two pixels: the larger one is named, marked in what is cut out around it, and
// white in the map.
TEST(PictureViewer, ShowsThePixelThatDiffersMost) {
  constexpr int width = 40, height = 20;
  const std::vector<Plane> first(3, Plane(size_t(width) * height, 0.5f));
  std::vector<Plane> second = first;
  second[1][2 * width + 3] = 0.6f;
  second[2][17 * width + 38] = 2;  // shown as 1
  const DisplayDifference difference = display_difference(first, second, width, height);
  EXPECT_EQ(difference.x, 38);
  EXPECT_EQ(difference.y, 17);
  EXPECT_FLOAT_EQ(difference.largest, 0.5f);
  EXPECT_FLOAT_EQ(difference.map[2 * width + 3], 0.1f);
  const auto pictures = viewed_pictures(first, second, {}, width, height, "here");
  ASSERT_TRUE(pictures && pictures->worst);
  EXPECT_EQ(pictures->worst->first, (std::array{128, 128, 128}));
  EXPECT_EQ(pictures->worst->second, (std::array{128, 128, 255}));
  const std::string html = viewer_html(*pictures);
  EXPECT_NE(html.find("Largest difference: 128 of 255 at pixel 38, 17"), std::string::npos);
  EXPECT_NE(html.find("data-mode=\"scaled\" "), std::string::npos);
  // 33 x 20 pixels are cut out, from 7, 0 on.
  EXPECT_NE(html.find(fmt::format("left:{:.4f}%;top:{:.4f}%", 100.0 * 31 / 33, 100.0 * 17 / 20)), std::string::npos);
  const auto alike = viewed_pictures(first, first, {}, width, height, "here");
  ASSERT_TRUE(alike);
  EXPECT_FALSE(alike->worst);
  EXPECT_EQ(viewer_html(*alike).find("Largest difference"), std::string::npos);
}

TEST(PictureViewer, CutsOutPartsThatLieInThePicture) {
  DisplayImage image{.width = 3, .height = 2};
  for (int i = 0; i < 18; ++i) image.pixels.push_back(std::byte(i));
  const Around part = square_around(2, 1, 2, 3, 2);
  EXPECT_EQ(std::tuple(part.x, part.y, part.width, part.height), std::tuple(1, 0, 2, 2));
  const DisplayImage cut = cut_out(image, part);
  ASSERT_EQ(cut.pixels.size(), 12u);
  EXPECT_EQ(cut.pixels[0], std::byte(3));
  EXPECT_EQ(cut.pixels[6], std::byte(12));
  const Around all = square_around(0, 0, 33, 3, 2);
  EXPECT_EQ(std::tuple(all.x, all.y, all.width, all.height), std::tuple(0, 0, 3, 2));
}

TEST(PictureViewer, HoldsEachPictureOnceAndEveryMode) {
  const auto bytes = [](std::string_view text) {
    const auto span = std::as_bytes(std::span(text.data(), text.size()));
    return std::vector<std::byte>(span.begin(), span.end());
  };
  CompareReport report{.reference = "a<b>.exr", .test = "c.exr", .metrics = {{"flip", 0.125}}};
  report.limits = {{"flip", 0.125, 0.1, false}};
  report.pictures = {.first_png = bytes("f"), .second_png = bytes("fo"), .heat_png = bytes("foo")};
  const std::string html = compare_html(report);
  const auto times = [&](std::string_view text) {
    int count = 0;
    for (size_t at = html.find(text); at != std::string::npos; at = html.find(text, at + 1)) ++count;
    return count;
  };
  for (const char* picture : {"base64,Zg==\"", "base64,Zm8=\"", "base64,Zm9v\""})
    EXPECT_EQ(times(picture), 1) << picture;
  for (const char* mode : {"beside", "slide", "blink", "heat"})
    EXPECT_EQ(times("<button type=\"button\" data-mode=\"" + std::string(mode)), 1) << mode;
  EXPECT_EQ(times("a&lt;b&gt;.exr"), 3);  // title, heading and facts
  EXPECT_EQ(times("<td class=\"text\">flip</td><td class=\"bad\">0.125</td><td class=\"bad\">0.1</td></tr>"), 1);
  EXPECT_EQ(times("#000004"), 1);  // the colour bar begins with magma's first
  EXPECT_EQ(times("http"), 0);     // nothing from outside
  report.pictures.heat_png.clear();
  EXPECT_EQ(compare_html(report).find("data-mode=\"heat\">"), std::string::npos);
}

TEST(GoldenJunit, CountsAndFailures) {
  const std::string xml = golden_junit(rows(), "golden");
  EXPECT_NE(xml.find("tests=\"4\" failures=\"1\""), std::string::npos) << xml;
  EXPECT_NE(xml.find("time=\"1.750\""), std::string::npos);
  EXPECT_NE(xml.find("<testcase classname=\"golden.cpu\" name=\"z &lt;broken&gt; &amp; &quot;quoted&quot;\" "
                     "time=\"1.000\"><failure "
                     "message=\"differs &lt;b&gt;\" type=\"failed\">"),
            std::string::npos)
      << xml;
  EXPECT_NE(xml.find("identical; blank frame"), std::string::npos);
  EXPECT_NE(xml.find("<system-out>warned; warning: 7 pixels &lt; all</system-out>"), std::string::npos) << xml;
}

}  // namespace
}  // namespace candela
