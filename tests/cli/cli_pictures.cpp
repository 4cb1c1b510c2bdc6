#include <gtest/gtest.h>

#include <algorithm>

#include "image/io.h"
#include "program.h"

namespace candela::test {
namespace {

// Pictures for people: what stands behind them, and how much is said of them.

std::vector<float> corner(const std::string& file) {
  const auto image = read_image(file);
  EXPECT_TRUE(image) << file;
  std::vector<float> values;
  for (const Channel& channel : image->channels) values.push_back(channel.f[0]);
  return values;
}

TEST(Background, AColourIsInPngAsItIsAndLinearPicturesStayTransparent) {
  const TestFolder folder;
  for (const auto& [text, codes] :
       std::vector<std::pair<std::string, std::vector<float>>>{{"white", {255, 255, 255}}, {"#1e9", {17, 238, 153}}}) {
    const Ended ended = candela({"render", scene("unlit-box"), "--size", "32x18", "--background", text, "-o",
                                 folder / "a.png", "-o", folder / "a.exr"});
    ASSERT_EQ(ended.code, 0) << ended.err;
    std::vector<float> expected = codes;
    for (float& v : expected) v /= 255;
    EXPECT_EQ(corner(folder / "a.png"), expected) << text;
    const auto linear = read_image(folder / "a.exr");
    ASSERT_TRUE(linear && linear->find("A"));
    EXPECT_EQ(linear->find("A")->f[0], 0);
  }
  const Ended traced = candela({"reference", scene("unlit-box"), "--size", "16x9", "--spp", "1", "--background", "#fff",
                                "-o", folder / "r.png", "--quiet"});
  ASSERT_EQ(traced.code, 0) << traced.err;
  EXPECT_EQ(corner(folder / "r.png"), (std::vector<float>{1, 1, 1}));
  EXPECT_EQ(candela({"render", scene("unlit-box"), "-o", folder / "b.png", "--background", "whitish"}).code, 2);
}

TEST(Layers, AllOfThemAreOneWord) {
  const TestFolder folder;
  const std::string alpha = folder / "alpha.glb";
  ASSERT_EQ(candela({"make-scene", "alpha", "-o", alpha}).code, 0);
  for (const char* method : {"sorted", "weighted"}) {
    const Ended ended = candela({"render", alpha, "--size", "24x16", "--quality", "draft", "--layers", "all",
                                 "--transparency", method, "-o", folder / "a.exr", "--verbose"});
    ASSERT_EQ(ended.code, 0) << ended.err;
    const auto image = read_image(folder / "a.exr");
    ASSERT_TRUE(image);
    EXPECT_TRUE(image->find("depth.Z") && image->find("normal.X") && image->find("albedo.R"));
    EXPECT_EQ(ended.err.find("layers that divide beauty are left out") != std::string::npos,
              method == std::string("weighted"));
    EXPECT_EQ(bool(image->find("ambient_diffuse.R")) || bool(image->find("emission.R")),
              method == std::string("sorted"));
  }
}

// An axis that points up and a camera of the file's axes are those of the same file turned.
TEST(UpAxis, TurnsTheSceneAndTheCameraThatIsGivenWithIt) {
  const TestFolder folder;
  const std::string box = scene("unlit-box");
  const auto render = [&](const char* file, std::vector<std::string> more) {
    more.insert(more.begin(), {"render", box, "--size", "32x18", "--yfov", "60", "-o", folder / file, "--quiet"});
    EXPECT_EQ(candela(more).code, 0);
  };
  // Along the axis that is up a view has no up of its own: x is to the right in both.
  render("y.exr", {"--eye", "0,0,5", "--target", "0,0,0"});
  render("z.exr", {"--up", "z", "--eye", "0,-5,0", "--target", "0,0,0"});
  EXPECT_NE(bytes_of(folder / "y.exr"), bytes_of(folder / "z.exr")) << "another side of the box";
  EXPECT_EQ(candela({"render", box, "--up", "up", "-o", folder / "a.png"}).code, 2);
}

TEST(Messages, APlainRenderSaysAtMostFiveLines) {
  const TestFolder folder;
  const Ended plain = candela({"render", scene("unlit-box"), "--size", "24x16", "--frames", "0-2", "--look", "none",
                               "-o", folder / "####.png", "-o", folder / "####.exr"});
  ASSERT_EQ(plain.code, 0) << plain.err;
  EXPECT_EQ(plain.err.find("device "), 0u) << plain.err;
  EXPECT_NE(plain.err.find("wrote " + folder / "0000.png" + ", " + folder / "0000.exr"), std::string::npos)
      << plain.err;
  const Ended one = candela({"render", scene("unlit-box"), "--size", "24x16", "-o", folder / "a.png"});
  EXPECT_LE(std::count(one.err.begin(), one.err.end(), '\n'), 5) << one.err;
}

}  // namespace
}  // namespace candela::test
