// Regions and overscan as files hold them: windows of EXR, pixels of PNG.
#include <gtest/gtest.h>

#include <cstring>

#include "base/files.h"
#include "image/io.h"
#include "program.h"

namespace candela::test::cli_region {
namespace {

using Arguments = std::vector<std::string>;

class CliRegion : public ::testing::Test {
 protected:
  FloatImage made(const std::string& command, const std::string& file, Arguments more) {
    Arguments words = {command, scene("spheres"), "-o", folder / file, "--size", "64x36", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = candela(words);
    EXPECT_EQ(ended.code, 0) << ended.err;
    auto image = read_image(folder / file);
    EXPECT_TRUE(image) << (image ? "" : image.error().text());
    return image ? std::move(*image) : FloatImage{};
  }
  // Channel by channel, bit for bit.
  static void expect_part(const FloatImage& whole, const FloatImage& part, int x, int y) {
    ASSERT_EQ(part.channels.size(), whole.channels.size());
    for (size_t c = 0; c < part.channels.size(); ++c) {
      SCOPED_TRACE(part.channels[c].name);
      ASSERT_EQ(part.channels[c].name, whole.channels[c].name);
      int differing = 0;
      for (int row = 0; row < part.height; ++row)
        for (int column = 0; column < part.width; ++column) {
          const size_t a = size_t(row) * size_t(part.width) + size_t(column),
                       b = size_t(y + row) * size_t(whole.width) + size_t(x + column);
          const Channel &p = part.channels[c], &w = whole.channels[c];
          differing += p.type == ChannelType::uint32 ? p.u[a] != w.u[b] : std::memcmp(&p.f[a], &w.f[b], 4) != 0;
        }
      EXPECT_EQ(differing, 0);
    }
  }
  static void expect_windows(const FloatImage& image, int x, int y, int width, int height) {
    EXPECT_EQ(image.width, width);
    EXPECT_EQ(image.height, height);
    EXPECT_EQ(image.origin_x, x);
    EXPECT_EQ(image.origin_y, y);
    EXPECT_EQ(image.display_width, 64);
    EXPECT_EQ(image.display_height, 36);
  }
  void refused(const Arguments& more, const std::string& part) {
    Arguments words = {"render", scene("spheres"), "-o", folder / "no.exr", "--size", "64x36"};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = candela(words);
    EXPECT_EQ(ended.code, 2) << ended.err;
    EXPECT_NE(ended.err.find(part), std::string::npos) << ended.err;
  }
  TestFolder folder;
};

TEST_F(CliRegion, RendersARegionAsTheDataWindow) {
  const FloatImage whole = made("render", "whole.exr", {"--layers", "depth,object_id"});
  const FloatImage part = made("render", "part.exr", {"--layers", "depth,object_id", "--region", "13,7,21,18"});
  expect_windows(part, 13, 7, 21, 18);
  expect_part(whole, part, 13, 7);
  const FloatImage png = made("render", "whole.png", {}),
                   part_png = made("render", "part.png", {"--region", "13,7,21,18"});
  EXPECT_EQ(part_png.width, 21);
  expect_part(png, part_png, 13, 7);
}

TEST_F(CliRegion, TracesARegionAsTheDataWindow) {
  for (const char* mode : {"direct", "path"}) {
    SCOPED_TRACE(mode);
    const std::string name = mode;
    const Arguments traced = {"--mode", mode, "--spp", "2", "--layers", "all"};
    Arguments of_part = traced;
    of_part.insert(of_part.end(), {"--region", "13,7,21,18"});
    const FloatImage whole = made("reference", name + "_whole.exr", traced),
                     part = made("reference", name + "_part.exr", of_part);
    expect_windows(part, 13, 7, 21, 18);
    expect_part(whole, part, 13, 7);
  }
  const FloatImage png = made("reference", "whole.png", {"--spp", "2"}),
                   part_png = made("reference", "part.png", {"--spp", "2", "--region", "13,7,21,18"});
  expect_part(png, part_png, 13, 7);
}

// Frames of a film are regions as a picture is, of both renderers, and video has the region's size.
TEST_F(CliRegion, FilmsHaveRegionsOfTheirFrames) {
  for (const std::string technique : {"auto", "reference"}) {
    SCOPED_TRACE(technique);
    const auto film = [&](const std::string& name, Arguments more) {
      Arguments words = {"sequence",
                         scene("animated"),
                         "--size",
                         "64x36",
                         "--frames",
                         "3-4",
                         "--quiet",
                         "--technique",
                         technique,
                         "-o",
                         folder / (name + "-%d.exr"),
                         "-o",
                         folder / (name + "-%d.png")};
      if (technique == "reference") words.insert(words.end(), {"--spp", "1"});
      words.insert(words.end(), more.begin(), more.end());
      const Ended ended = candela(words);
      EXPECT_EQ(ended.code, 0) << ended.err;
    };
    const Arguments region = {"--region", "13,7,21,18"};
    film(technique + "-whole", {});
    film(technique + "-part", region);
    const auto read = [&](const std::string& name) {
      auto image = read_image(folder / name);
      EXPECT_TRUE(image) << name;
      return image ? std::move(*image) : FloatImage{};
    };
    for (const char* frame : {"3", "4"}) {
      const FloatImage part = read(technique + "-part-" + frame + ".exr");
      expect_windows(part, 13, 7, 21, 18);
      expect_part(read(technique + "-whole-" + frame + ".exr"), part, 13, 7);
      expect_part(read(technique + "-whole-" + frame + ".png"), read(technique + "-part-" + frame + ".png"), 13, 7);
    }
    // A film that goes on finds its frames, and those of another region are none.
    Arguments again = region;
    again.push_back("--resume");
    film(technique + "-part", again);
    if (run_program({"ffmpeg", "-version"}).code != 0) continue;
    again.insert(again.end(), {"--video", folder / (technique + "-again.mp4"), "--video-pad"});
    film(technique + "-part", again);  // of frames that were there
    EXPECT_TRUE(std::filesystem::exists(folder / (technique + "-again.mp4"))) << technique;
    for (const auto& [asked, size] : {std::pair("13,7,21,18", "22x18"), {"0,0,20,10", "20x10"}}) {
      const std::string video = folder / (technique + ".mp4");
      Arguments words = {"sequence", scene("animated"), "--size", "65x37",    "--frames", "3-4",        "--technique",
                         technique,  "--video",         video,    "--region", asked,      "--video-pad"};
      if (technique == "reference") words.insert(words.end(), {"--spp", "1"});
      const Ended ended = candela(words);
      ASSERT_EQ(ended.code, 0) << ended.err;
      const std::string still = folder / (technique + std::string(size) + ".png");
      ASSERT_EQ(run_program({"ffmpeg", "-loglevel", "error", "-i", video, "-frames:v", "1", still}).code, 0);
      const FloatImage picture = read(technique + std::string(size) + ".png");
      EXPECT_EQ(fmt::format("{}x{}", picture.width, picture.height), size);
    }
  }
}

// As compositors know it: pixels beyond the display window.
TEST_F(CliRegion, OverscanIsALargerDataWindow) {
  for (const char* command : {"render", "reference"}) {
    SCOPED_TRACE(command);
    const std::string name = command;
    const Arguments few = name == "render" ? Arguments{"--quality", "draft"} : Arguments{"--spp", "1"};
    const auto with = [&](Arguments more) {
      more.insert(more.end(), few.begin(), few.end());
      return more;
    };
    expect_windows(made(name, name + "_px.exr", with({"--overscan", "5"})), -5, -5, 74, 46);
    const FloatImage all = made(name, name + "_percent.exr", with({"--overscan", "10%"}));
    expect_windows(all, -7, -4, 78, 44);
    const FloatImage part = made(name, name + "_part.exr", with({"--overscan", "10%", "--region", "-7,-2,30,12"}));
    expect_windows(part, -7, -2, 30, 12);
    expect_part(all, part, 0, 2);
  }
}

TEST_F(CliRegion, SaysWhatIsWrong) {
  refused({"--region", "60,0,10,10"}, "--region: 60,0,10,10 reaches beyond the picture, which is 64x36");
  refused({"--region", "1,2,3"}, "write X,Y,WIDTH,HEIGHT");
  refused({"--overscan", "-3"}, "--overscan");
  refused({"--overscan", "10000"}, "more than 16384x16384");
  refused({"--region", "0,0,8,8", "--check-determinism", "2"}, "--check-determinism: looks at whole images");
  refused({"--region", "0,0,8,8", "--dump", "resolve.resolved"}, "--dump: looks at whole images");
}

TEST_F(CliRegion, LightGroupsAreLayers) {
  for (const char* command : {"render", "reference"}) {
    const std::string name = command;
    Arguments words = {command,
                       scene("street"),
                       "-o",
                       folder / (name + ".exr"),
                       "--size",
                       "32x18",
                       "--quiet",
                       "--light-groups",
                       "lamps=street*",
                       "--light-groups",
                       "shops=signs,windows"};
    if (name == "reference") words.insert(words.end(), {"--spp", "1"});
    const Ended ended = candela(words);
    ASSERT_EQ(ended.code, 0) << ended.err;
    const auto image = read_image(folder / (name + ".exr"));
    ASSERT_TRUE(image);
    for (const char* layer : {"light_lamps.R", "light_shops.G", "light_rest.B"})
      EXPECT_NE(image->find(layer), nullptr) << command << " " << layer;
    // Shown alone, and beside the file that holds all of them.
    const auto shown = [&](const std::string& view, const std::string& file, Arguments outputs) {
      Arguments these = words;
      these[3] = folder / file;
      these.insert(these.end(), {"--view", view});
      these.insert(these.end(), outputs.begin(), outputs.end());
      const Ended made = candela(these);
      EXPECT_EQ(made.code, 0) << made.err;
      return read_file(folder / file);
    };
    const auto alone = shown("light_lamps", name + "_alone.png", {});
    ASSERT_TRUE(alone);
    const std::string all = folder / (name + "_all.exr");
    EXPECT_EQ(*shown("light_lamps", name + "_both.png", {"-o", all}), *alone) << command;
    const auto beside = read_image(all);
    ASSERT_TRUE(beside);
    EXPECT_NE(beside->find("light_lamps.R"), nullptr) << command;
    EXPECT_NE(*shown("light_rest", name + "_rest.png", {}), *alone) << command;
    words.insert(words.end(), {"--view", "light_lmaps"});
    const Ended unknown = candela(words);
    EXPECT_EQ(unknown.code, 2);
    EXPECT_NE(unknown.err.find("did you mean 'light_lamps'"), std::string::npos) << unknown.err;
  }
  refused({"--light-groups", "a"}, "write NAME=NODE,NODE");
}

}  // namespace
}  // namespace candela::test::cli_region
