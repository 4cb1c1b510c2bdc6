// What a plain command decides for itself: light, camera, clips, exposure; each said, and the same for each frame.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "image/io.h"
#include "program.h"

namespace candela::test::cli_defaults {
namespace {

// A triangle that three clips move: 10 m along x in a second, the same along y, and by its scale. lamp_cd above 0: a
// point light of so much before it.
std::string moving(const TestFolder& folder, double lamp_cd = 0) {
  const float numbers[] = {0, 0, 0, 1,  0,  0, 0, 1, 0,  // positions
                           0, 1,                         // times
                           0, 0, 0, 10, 0,  0,           // along x
                           0, 0, 0, 0,  10, 0,           // along y
                           1, 1, 1, 1,  1,  1};          // scale
  std::ofstream(folder / "moving.bin", std::ios::binary).write(reinterpret_cast<const char*>(numbers), sizeof numbers);
  using Json = nlohmann::json;
  const auto view = [](int offset, int length) {
    return Json{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}};
  };
  const auto clip = [](const char* name, int output, const char* path) {
    return Json{{"name", name},
                {"samplers", {{{"input", 1}, {"output", output}}}},
                {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}};
  };
  Json j = {{"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", {0}}}}},
            {"nodes", {{{"mesh", 0}}}},
            {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}}},
            {"buffers", {{{"byteLength", sizeof numbers}, {"uri", "moving.bin"}}}},
            {"bufferViews", {view(0, 36), view(36, 8), view(44, 24), view(68, 24), view(92, 24)}},
            {"animations", {clip("x", 2, "translation"), clip("y", 3, "translation"), clip("size", 4, "scale")}}};
  j["accessors"] = {
      {{"bufferView", 0},
       {"componentType", 5126},
       {"type", "VEC3"},
       {"count", 3},
       {"min", {0, 0, 0}},
       {"max", {1, 1, 0}}},
      {{"bufferView", 1}, {"componentType", 5126}, {"type", "SCALAR"}, {"count", 2}, {"min", {0}}, {"max", {1}}}};
  for (int v = 2; v < 5; ++v)
    j["accessors"].push_back({{"bufferView", v}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 2}});
  if (lamp_cd > 0) {
    j["extensionsUsed"] = {"KHR_lights_punctual"};
    j["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", lamp_cd}}};
    j["nodes"].push_back({{"translation", {0.3, 0.3, 1}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    j["scenes"][0]["nodes"] = {0, 1};
  }
  std::ofstream(folder / "moving.gltf") << j.dump();
  return folder / "moving.gltf";
}

std::string said(const Ended& ended) { return ended.err + ended.out; }

// One camera for a film: a frame has the same bytes alone, in the film and in a shard, and the triangle moves in it.
TEST(Defaults, AFilmHasOneCamera) {
  const TestFolder folder;
  const std::string file = moving(folder);
  const auto film = [&](const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> words = {"sequence", file, "--frames", "0-24x12", "-o", out, "--size", "48x32"};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = candela(words);
    EXPECT_EQ(ended.code, 0) << ended.err;
  };
  film(folder / "all%02d.png", {});
  film(folder / "shard%02d.png", {"--shard", "2/3"});
  ASSERT_EQ(candela({"render", file, "--frame", "12", "-o", folder / "alone.png", "--size", "48x32"}).code, 0);
  EXPECT_EQ(bytes_of(folder / "all12.png"), bytes_of(folder / "alone.png"));
  EXPECT_EQ(bytes_of(folder / "all12.png"), bytes_of(folder / "shard12.png"));
  const auto alike = [&](const char* a, const char* b) {
    return candela({"compare", folder / a, folder / b, "--limit", "max=0.01"}).code == 0;
  };
  EXPECT_FALSE(alike("all00.png", "all24.png"));
  // What follows sees the triangle in the same place at all times, whatever moves it.
  film(folder / "follow%02d.png", {"--follow", "--no-dither"});
  EXPECT_TRUE(alike("follow00.png", "follow12.png"));
}

// Motion is the object's: the film's camera stands.
TEST(Defaults, MotionIsOfWhatMoves) {
  const TestFolder folder;
  const std::string file = moving(folder);
  const auto motion = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"render",         file,         "--frame", "12",     "--layers", "motion", "-o",
                                      folder / "a.exr", "--exr-type", "float",   "--size", "96x64"};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(candela(words).code, 0);
    const auto image = read_image(folder / "a.exr");
    EXPECT_TRUE(image);
    double most = 0;
    for (const Channel& channel : image->channels)
      if (channel.name.starts_with("motion"))
        for (const float v : channel.f) most = std::max(most, double(std::abs(v)));
    return most;
  };
  EXPECT_GT(motion({}), 1);
  EXPECT_LT(motion({"--follow"}), 0.01);
  EXPECT_EQ(candela({"render", file, "--follow", "--eye", "0,0,9", "--target", "0,0,0", "-o", folder / "b.png"}).code,
            2);
}

TEST(Defaults, ClipsThatMoveTheSameAreNamed) {
  const TestFolder folder;
  const std::string file = moving(folder);
  const Ended facts = candela({"facts", file, "--json"});
  ASSERT_EQ(facts.code, 0) << facts.err;
  const auto clips = nlohmann::json::parse(facts.out).at("clips");
  ASSERT_EQ(clips.size(), 3u);
  EXPECT_TRUE(clips[0].at("plays") && !clips[1].at("plays") && clips[2].at("plays"));
  EXPECT_EQ(clips[1].at("conflicts_with"), 0);
  const Ended people = candela({"facts", file});
  for (const char* text : {"bounds", "'x', 1.000 s, 1 target, plays", "1 of its channels is driven by 0 'x' too",
                           "1 of 3 animations do not play", "the studio"})
    EXPECT_NE(people.out.find(text), std::string::npos) << text << "\n" << people.out;
  const Ended all =
      candela({"sequence", file, "--frames", "all", "--fps", "4", "-o", folder / "%d.png", "--size", "8x8"});
  EXPECT_EQ(all.code, 0) << all.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "4.png") && !std::filesystem::exists(folder / "5.png"));
  const Ended none = candela({"sequence", file, "--frames", "all", "--animation", "none", "-o", folder / "n%d.png"});
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("none does; write 0-249"), std::string::npos) << none.err;
}

TEST(Defaults, WhatIsBurntOutOrBlackIsSaid) {
  const TestFolder folder;
  const std::string bright = moving(folder, 54351);
  const std::vector<std::string> picture = {"-o",    folder / "a.png", "--size",   "32x32",
                                            "--eye", "0.3,0.3,2",      "--target", "0.3,0.3,0"};
  const auto render = [&](const std::string& file, std::vector<std::string> more) {
    std::vector<std::string> words = {"render", file};
    words.insert(words.end(), picture.begin(), picture.end());
    words.insert(words.end(), more.begin(), more.end());
    return candela(words);
  };
  const Ended plain = render(bright, {});
  EXPECT_EQ(plain.code, 0);
  EXPECT_NE(plain.err.find("of the picture is clipped to white: try --exposure auto, which is --exposure -1"),
            std::string::npos)
      << plain.err;
  const Ended metered = render(bright, {"--exposure", "auto"});
  EXPECT_EQ(metered.code, 0);
  EXPECT_EQ(metered.err.find("clipped"), std::string::npos) << metered.err;
  EXPECT_NE(metered.err.find("stops for all frames"), std::string::npos) << metered.err;
  EXPECT_EQ(render(bright, {"--exposure", "bright"}).code, 2);

  const std::string dark = moving(folder);
  const Ended none = render(dark, {"--sky", "none"});
  EXPECT_EQ(none.code, 0);
  EXPECT_NE(none.err.find("every pixel is black"), std::string::npos) << none.err;
  EXPECT_EQ(render(dark, {"--sky", "none", "--strict"}).code, 3);
  EXPECT_EQ(render(dark, {"--sky", "none", "--strict", "--allow-blank"}).code, 0);
  EXPECT_EQ(said(render(dark, {"--strict"})).find("black"), std::string::npos);
}

// One line a code, with the first place and how many more there are.
TEST(Defaults, FaultsOfOneKindAreOneLine) {
  const TestFolder folder;
  auto json = nlohmann::json::parse(bytes_of(moving(folder)));
  json["scenes"][0]["nodes"] = {0, 0, 0, 0};
  std::ofstream(folder / "moving.gltf") << json.dump();
  const Ended brief = candela({"facts", folder / "moving.gltf"});
  EXPECT_NE(brief.err.find("/scenes/0/nodes/1: node 0 is listed twice"), std::string::npos) << brief.err;
  EXPECT_NE(brief.err.find("(DUPLICATE_ELEMENTS), and 2 more (--verbose)"), std::string::npos) << brief.err;
  EXPECT_EQ(brief.err.find("/scenes/0/nodes/2"), std::string::npos) << brief.err;
  EXPECT_NE(candela({"facts", folder / "moving.gltf", "--verbose"}).err.find("/scenes/0/nodes/3"), std::string::npos);
}

TEST(Defaults, HelpIsOneScreen) {
  for (const char* command : {"render", "sequence", "reference", "facts"}) {
    const Ended brief = candela({command, "-h"}), whole = candela({command, "--help"}),
                word = candela({"help", command});
    EXPECT_EQ(brief.code, 0);
    EXPECT_LE(std::ranges::count(brief.out, '\n'), 30) << brief.out;
    EXPECT_NE(brief.out.find(std::string("All options: candela ") + command + " --help"), std::string::npos)
        << brief.out;
    EXPECT_GT(whole.out.size(), brief.out.size());
    EXPECT_EQ(word.code, 0);
    EXPECT_NE(word.out.find("--verbose"), std::string::npos);
  }
  const Ended wrong = candela({"render", "a.glb", "-o", "a.png", "--time", "abc"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.err.find("--time: 'abc' is not a number (SECONDS); write for example --time 2"), std::string::npos)
      << wrong.err;
  EXPECT_EQ(candela({"help", "rendr"}).code, 2);
  EXPECT_EQ(candela({"help"}).out, candela({"--help"}).out);
  const auto lines = [](const Ended& ended) { return std::ranges::count(ended.out, '\n'); };
  EXPECT_LT(lines(candela({"list", "knobs"})), lines(candela({"list", "knobs", "--all"})));
}

TEST(Defaults, EffectsHaveOneNameAndOthersAreUnderstood) {
  const TestFolder folder;
  const std::string file = moving(folder);
  EXPECT_EQ(candela({"plan", file, "--effects", "reflections"}).code, 0);
  const Ended ao = candela({"plan", file, "--effects", "ao"});
  EXPECT_EQ(ao.code, 2);
  EXPECT_NE(ao.err.find("it is called occlusion here"), std::string::npos) << ao.err;
}

// What scripts and kept jobs call by a name of before goes on, and a line says the new one; files have the new one.
TEST(Defaults, OldNamesAnswerWithTheNewOnes) {
  const TestFolder folder;
  const std::string file = folder / "old.exr";
  const Ended old =
      candela({"render", scene("spheres"), "--size", "16x9", "--layers", "shadow,direct.sun,object_id", "--set",
               "shadows.lights=2", "--set", "fog.lamp_shadows=2", "--effects", "shadows,ssr", "-o", file, "--verbose"});
  ASSERT_EQ(old.code, 0) << old.err;
  for (const char* line :
       {"the layer shadow is now called shadow_sun", "the layer direct.sun is now called direct_sun",
        "the table of knobs shadows is now called local", "the knob fog.lamp_shadows is now called fog.local_shadows",
        "the effect ssr is now called reflections"})
    EXPECT_NE(old.err.find(line), std::string::npos) << line << "\n" << old.err;
  const auto image = read_image(file);
  ASSERT_TRUE(image);
  for (const char* channel : {"shadow_sun.Y", "direct_sun.R", "object_id.X"})
    EXPECT_NE(image->find(channel), nullptr) << channel;
  for (const Channel& channel : image->channels)
    EXPECT_LE(std::ranges::count(channel.name, '.'), 1) << channel.name << ": compositors split there";
  const Ended now = candela({"render", scene("spheres"), "--size", "16x9", "--layers",
                             "shadow_sun,direct_sun,object_id", "--set", "local.lights=2", "--set",
                             "fog.local_shadows=2", "--effects", "shadows,reflections", "-o", folder / "now.exr"});
  ASSERT_EQ(now.code, 0) << now.err;
  EXPECT_EQ(now.err.find("now called"), std::string::npos) << now.err;
  EXPECT_EQ(bytes_of(file), bytes_of(folder / "now.exr"));
}

}  // namespace
}  // namespace candela::test::cli_defaults
