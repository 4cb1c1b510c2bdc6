#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "image/exr.h"
#include "image/io.h"
#include "program.h"

namespace candela::test {
namespace {

const std::string box = scene("unlit-box"), spheres = scene("spheres");

std::vector<std::string> traced(const std::string& out, std::vector<std::string> more = {}) {
  std::vector<std::string> words = {"reference", spheres, "--size", "24x16", "-o", out, "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

}  // namespace

TEST(Reference, WritesBothFormatsWithLayersAndMetadata) {
  const TestFolder folder;
  const Ended ended =
      candela({"reference", spheres, "--size", "24x16", "--spp", "4", "-o", folder / "a.exr", "-o", folder / "a.png",
               "--layers", "variance,heatmap_traversal,heatmap_leaves", "--frame", "3", "--json"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  const auto json = nlohmann::json::parse(ended.out);
  EXPECT_EQ(json["spp"], 4);
  EXPECT_EQ(json["reference"]["mode"], "direct");
  EXPECT_GT(json["bvh"]["triangles"], 0);
  const auto image = read_image(folder / "a.exr");
  ASSERT_TRUE(image);
  for (const char* name : {"R", "A", "variance.G", "heatmap_traversal.Y", "heatmap_leaves.Y"})
    EXPECT_TRUE(image->find(name)) << name;
  std::set<std::string> entries;
  for (const MetadataEntry& entry : image->metadata) entries.insert(entry.name);
  for (const char* name : {"worldToCamera", "candela:reference", "candela:spp", "candela:mse", "candela:job"})
    EXPECT_TRUE(entries.contains(name)) << name;
  EXPECT_TRUE(read_image(folder / "a.png"));
  // Its variance does not hinder a comparison with a picture that has none.
  EXPECT_EQ(candela(traced(folder / "v.exr", {"--spp", "4"})).code, 0);
  EXPECT_EQ(candela(traced(folder / "n.exr", {"--spp", "4", "--layers", "none"})).code, 0);
  const Ended same = candela({"compare", folder / "v.exr", folder / "n.exr", "--limit", "max=0"});
  EXPECT_EQ(same.code, 0) << same.err;
}

// The sun of a sky image is a light in both modes: the picture's light is that of the image with the sun in it, and
// the background is the same to the bit.
TEST(Reference, TheSunOfASkyImageIsALight) {
  const TestFolder folder;
  FloatImage sky;
  sky.width = 128, sky.height = 64;
  for (const char* channel : {"R", "G", "B"}) {
    sky.channels.push_back({channel, ChannelType::float32, {}, {}});
    for (int i = 0; i < sky.width * sky.height; ++i)
      sky.channels.back().f.push_back(i == 20 * sky.width + 90 || i == 20 * sky.width + 91 ? 600 : 0.5f);
  }
  const auto bytes = encode_exr(sky, ExrCompression::zip, "sky");
  ASSERT_TRUE(bytes);
  std::ofstream(folder / "sky.exr", std::ios::binary).write(bytes->data(), long(bytes->size()));
  std::ofstream(folder / "kept.json") << R"({"sky": {"extract_sun": false}})";
  std::ofstream(folder / "taken.json") << R"({"sky": {"extract_sun": true}})";
  const std::string plain = scene("instanced");
  for (const std::string mode : {"direct", "path"}) {
    double mean[2], suns[2];  // the scene has a sun of its own
    std::vector<float> background[2];
    for (const bool taken : {false, true}) {
      const std::string out = folder / (mode + (taken ? "_taken.exr" : "_kept.exr"));
      const Ended ended = candela({"reference", plain, "--size", "48x32", "--spp", "64", "--mode", mode, "--sky",
                                   folder / "sky.exr", "--look", folder / (taken ? "taken.json" : "kept.json"), "-o",
                                   out, "--exr-type", "float", "--layers", "background,ambient_diffuse,direct_sun"});
      ASSERT_EQ(ended.code, 0) << ended.err;
      EXPECT_EQ(ended.err.find("sun is a directional light") != std::string::npos, taken) << ended.err;
      const auto image = read_image(out);
      ASSERT_TRUE(image);
      const auto& green = image->find("G")->f;
      mean[taken] = std::accumulate(green.begin(), green.end(), 0.0) / double(green.size());
      background[taken] = image->find("background.G")->f;
      const auto& sun = image->find("direct_sun.G")->f;
      suns[taken] = std::accumulate(sun.begin(), sun.end(), 0.0);
    }
    EXPECT_NEAR(mean[1], mean[0], 0.02 * mean[0]) << mode;
    EXPECT_GT(suns[1], 1.2 * suns[0]) << mode;
    EXPECT_EQ(background[1], background[0]) << mode;
  }
}

// --footprints: within the squares of a textured scene 4 samples a pixel are nearer to 256 than points are. The file
// says so, and where nothing is textured no pixel changes.
TEST(Reference, FootprintsAreMeansOfTextures) {
  const TestFolder folder;
  const auto traced_of = [&](const std::string& file, std::vector<std::string> more) {
    more.insert(more.begin(), {"reference", file, "--size", "48x32", "--sampler", "uniform", "--layers", "none",
                               "--quiet", "--exr-type", "float", "--json", "-o", folder / "a.exr"});
    const Ended ended = candela(more);
    EXPECT_EQ(ended.code, 0) << ended.err;
    const bool said = nlohmann::json::parse(ended.out)["reference"].value("footprints", false);
    EXPECT_EQ(said, more.back() == "--footprints");
    auto image = read_image(folder / "a.exr");
    EXPECT_TRUE(image);
    return image ? *image : FloatImage{};
  };
  const auto values = [](const FloatImage& image, const char* channel) { return image.find(channel)->f; };
  const std::string squares = scene("texture-transform");
  const FloatImage truth = traced_of(squares, {"--spp", "256"}), points = traced_of(squares, {"--spp", "4"}),
                   means = traced_of(squares, {"--spp", "4", "--footprints"});
  const auto error = [&](const FloatImage& image) {
    double sum = 0;
    for (const char* channel : {"R", "G", "B"})
      for (size_t i = 0; i < 48 * 32; ++i)
        if (values(truth, "A")[i] == 1) sum += std::pow(values(image, channel)[i] - values(truth, channel)[i], 2);
    return sum;
  };
  EXPECT_LT(error(means), 0.01 * error(points)) << error(means) << " " << error(points);
  EXPECT_EQ(values(traced_of(spheres, {"--spp", "4"}), "R"),
            values(traced_of(spheres, {"--spp", "4", "--footprints"}), "R"));
}

// However the tree is built the picture is the same; what it was built of is in the JSON.
TEST(Reference, TreesChangeNoPicture) {
  const TestFolder folder;
  const auto picture = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.end(), {"--spp", "4", "--layers", "none", "--json"});
    const Ended ended = candela(traced(folder / name, more));
    EXPECT_EQ(ended.code, 0) << ended.err;
    return nlohmann::json::parse(ended.out)["bvh"];
  };
  const auto by_default = picture("a.exr", {});
  EXPECT_EQ(by_default["builder"], "sah");  // few rays for so many triangles
  const auto thesis = picture("b.exr", {"--bvh", "sbvh", "--set", "bvh.max-leaf=1", "--set", "bvh.block=0", "--set",
                                        "bvh.budget=0.5", "--set", "bvh.depth=20", "--set", "bvh.node-cost=0.125"});
  EXPECT_EQ(thesis["builder"], "sbvh");
  EXPECT_GT(thesis["binary_nodes"], by_default["binary_nodes"]);
  EXPECT_EQ(picture("c.exr", {"--bvh", "spatial-only"})["builder"], "spatial-only");
  for (const char* other : {"b.exr", "c.exr"}) {
    const Ended same = candela({"compare", folder / "a.exr", folder / other, "--limit", "max=0"});
    EXPECT_EQ(same.code, 0) << same.err;
  }
}

// The layers that a technique's frame has, by the same names and types, so that files of both compare layer by layer.
TEST(Reference, WritesTheLayersThatRenderWrites) {
  const TestFolder folder;
  const std::string layers = "depth,normal,albedo,object_id,material_id,emission";
  const auto made = [&](const std::string& command, const std::string& name) {
    const Ended ended =
        candela({command, spheres, "--size", "48x32", "--layers", layers, "-o", folder / name, "--quiet"});
    ASSERT_EQ(ended.code, 0) << ended.err;
  };
  made("render", "render.exr");
  made("reference", "reference.exr");
  const auto rendered = read_image(folder / "render.exr"), traced = read_image(folder / "reference.exr");
  ASSERT_TRUE(rendered && traced);
  std::map<std::string, ChannelType> of_render, of_reference;
  for (const Channel& channel : rendered->channels) of_render[channel.name] = channel.type;
  for (const Channel& channel : traced->channels) of_reference[channel.name] = channel.type;
  EXPECT_EQ(of_render, of_reference);
  const Ended compared =
      candela({"compare", folder / "reference.exr", folder / "render.exr", "--hdr-flip", "off", "--json"});
  ASSERT_EQ(compared.code, 0) << compared.err;
  const auto json = nlohmann::json::parse(compared.out)["layers"];
  std::map<std::string, nlohmann::json> by_name;
  for (const auto& layer : json) by_name[layer["name"]] = layer;
  EXPECT_EQ(by_name.size(), 6u) << json;
  EXPECT_LE(by_name["object_id"]["metrics"]["differing-share"], 0.01) << json;
  EXPECT_EQ(by_name["depth"]["kind"], "depth") << json;
  EXPECT_LT(by_name["depth"]["metrics"]["depth-rel-p99"], 1e-4) << json;
}

// Terms of beauty: they sum to it in the file, beauty is the same with and without them, and a state file of the one
// kind is refused for the other.
TEST(Reference, WritesTheTermsOfBeauty) {
  const TestFolder folder;
  const std::vector<std::string> terms = {"direct_sun",       "direct_point", "direct_spot", "ambient_diffuse",
                                          "ambient_specular", "emission",     "background",  "indirect"};
  const std::string layers = fmt::format("{},shadow_sun", fmt::join(terms, ","));
  const auto run = [&](const std::string& name, const std::string& wanted, std::vector<std::string> more = {}) {
    std::vector<std::string> options = {"--spp", "4", "--exr-type", "float", "--layers", wanted};
    options.insert(options.end(), more.begin(), more.end());
    return candela(traced(folder / name, options));
  };
  const Ended divided = run("terms.exr", layers, {"--state", folder / "s"});
  ASSERT_EQ(divided.code, 0) << divided.err;
  ASSERT_EQ(run("alone.exr", "none").code, 0);
  const auto with = read_image(folder / "terms.exr"), without = read_image(folder / "alone.exr");
  ASSERT_TRUE(with && without);
  ASSERT_TRUE(with->find("shadow_sun.Y"));
  for (const char* c : {"R", "G", "B"}) {
    const std::vector<float>& beauty = with->find(c)->f;
    EXPECT_EQ(beauty, without->find(c)->f);
    for (size_t i = 0; i < beauty.size(); ++i) {
      double sum = 0;
      for (const std::string& term : terms) sum += with->find(term + "." + c)->f[i];
      EXPECT_NEAR(sum, beauty[i], 1e-6 * (1 + beauty[i])) << c << " of pixel " << i;
    }
  }
  const Ended refused = run("more.exr", "none", {"--state", folder / "s", "--resume"});
  EXPECT_EQ(refused.code, 3);
  EXPECT_NE(refused.err.find("layers of single terms"), std::string::npos) << refused.err;
}

TEST(Reference, AResumedRunHasTheBytesOfAWholeOne) {
  const TestFolder folder;
  const std::vector<std::string> path = {"--mode", "path", "--bounces", "2"};
  const auto run = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.end(), path.begin(), path.end());
    const Ended ended = candela(traced(folder / name, more));
    EXPECT_EQ(ended.code, 0) << ended.err;
  };
  run("whole.exr", {"--spp", "10"});
  run("part.exr", {"--spp", "4", "--state", folder / "s"});
  run("resumed.exr", {"--spp", "10", "--state", folder / "s", "--resume", "--threads", "1"});
  EXPECT_EQ(bytes_of(folder / "whole.exr"), bytes_of(folder / "resumed.exr"));
  EXPECT_NE(bytes_of(folder / "whole.exr"), bytes_of(folder / "part.exr"));
  const Ended other =
      candela(traced(folder / "other.exr", {"--spp", "10", "--state", folder / "s", "--resume", "--seed", "2"}));
  EXPECT_EQ(other.code, 3);
  EXPECT_NE(other.err.find("another picture"), std::string::npos) << other.err;
}

// An interruption leaves whole batches, and what they are made into is what as many samples are at once.
TEST(Reference, AnInterruptionLeavesAStateToGoOnFrom) {
  const TestFolder folder;
  std::vector<std::string> words = traced(folder / "never.exr", {"--spp", "1000000", "--state", folder / "s"});
  ASSERT_TRUE(candela_killed_after(words, 700, SIGINT));
  EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{"s"});
  words = {"reference", spheres,      "--size",   "24x16", "-o", folder / "a.exr", "--quiet",
           "--state",   folder / "s", "--resume", "--spp", "2",  "--json"};
  const Ended resumed = candela(words);
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  const uint64_t spp = nlohmann::json::parse(resumed.out)["spp"];
  EXPECT_EQ(candela(traced(folder / "b.exr", {"--spp", std::to_string(spp)})).code, 0);
  EXPECT_EQ(bytes_of(folder / "a.exr"), bytes_of(folder / "b.exr"));
}

// Without --state what was traced lies beside the picture, and the message says how to go on.
TEST(Reference, AnInterruptionWithoutAStateKeepsItsSamplesToo) {
  const TestFolder folder;
  ASSERT_TRUE(candela_killed_after(traced(folder / "never.exr", {"--spp", "1000000"}), 900, SIGINT));
  EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{"never.exr.film"});
  ASSERT_TRUE(candela_killed_after(traced(folder / "never.exr", {"--spp", "1000000"}), 900, SIGINT));
  EXPECT_EQ(files_in(folder.path()).size(), 2u) << "no film takes another's place";
  EXPECT_EQ(candela(traced(folder / "a.exr", {"--spp", "2", "--state", folder / "never.exr.film", "--resume"})).code,
            0);
  EXPECT_EQ(candela(traced(folder / "a.exr", {"--spp", "0"})).code, 2);
}

// The limit on file sizes lets the picture through and not the sums, as a disk that is nearly full would.
TEST(Reference, APictureIsWrittenThoughItsStateCannotBe) {
  const TestFolder folder;
  const Ended ended =
      run_program({"bash", "-c", R"(trap '' XFSZ; ulimit -f 60; exec "$0" "$@")", CANDELA_PROGRAM, "reference", spheres,
                   "--size", "48x32", "--spp", "1", "-o", folder / "a.exr", "--state", folder / "s"});
  EXPECT_EQ(ended.code, 5) << ended.err;
  EXPECT_NE(ended.err.find("the samples so far are not kept"), std::string::npos) << ended.err;
  EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{"a.exr"});
  // Of one sample nobody knows how far it is off.
  EXPECT_NE(ended.err.find("1 sample a pixel"), std::string::npos) << ended.err;
  EXPECT_EQ(ended.err.find("standard error"), std::string::npos) << ended.err;
}

TEST(Reference, TakesNoThreadCountForAByte) {
  const TestFolder folder;
  for (const char* threads : {"1", "2", "5"})
    EXPECT_EQ(candela(traced(folder / (std::string(threads) + ".exr"), {"--spp", "4", "--threads", threads})).code, 0);
  EXPECT_EQ(bytes_of(folder / "1.exr"), bytes_of(folder / "2.exr"));
  EXPECT_EQ(bytes_of(folder / "1.exr"), bytes_of(folder / "5.exr"));
}

// Lights beyond what floats hold: exit 7 with the place, unless it is allowed.
TEST(Reference, RefusesWhatIsNotFinite) {
  const TestFolder folder;
  const std::string bytes = bytes_of(spheres);
  uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, 4);
  auto json = nlohmann::json::parse(bytes.substr(20, length));
  for (auto& light : json["extensions"]["KHR_lights_punctual"]["lights"]) light["intensity"] = 3e38;
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string out = bytes.substr(0, 20) + text + bytes.substr(20 + length);
  const uint32_t whole = uint32_t(out.size()), json_length = uint32_t(text.size());
  std::memcpy(out.data() + 8, &whole, 4);
  std::memcpy(out.data() + 12, &json_length, 4);
  std::ofstream(folder / "bright.glb", std::ios::binary) << out;
  std::vector<std::string> words = {"reference", folder / "bright.glb", "--size", "64x36", "--spp", "2",
                                    "-o",        folder / "x.exr",      "--quiet"};
  const Ended ended = candela(words);
  EXPECT_EQ(ended.code, 7) << ended.err;
  EXPECT_NE(ended.err.find("first at x"), std::string::npos) << ended.err;
  EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{"bright.glb"});
  words.push_back("--allow-nonfinite");
  EXPECT_EQ(candela(words).code, 0);
}

TEST(Reference, DrawsTheFogOfALookFile) {
  const TestFolder folder;
  const std::string look = folder / "look.json";
  std::ofstream(look) << R"({"fog": {"extinction": [0.1, 0.2, 0.3], "albedo": 0.5}})";
  const Ended ended = candela(traced(folder / "fog.exr", {"--spp", "4", "--look", look, "--fog-steps", "4", "--layers",
                                                          "fog,fog_transmittance", "--json"}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto json = nlohmann::json::parse(ended.out);
  EXPECT_EQ(json["job"]["look"], look);
  EXPECT_NE(json["notes"].dump().find("behind all of it"), std::string::npos) << json["notes"];
  EXPECT_EQ(json["reference"]["fog-steps"], 4);
  const auto image = read_image(folder / "fog.exr");
  ASSERT_TRUE(image);
  double light = 0, clear[2] = {0, 0};
  for (const char* name :
       {"fog.R", "fog.G", "fog.B", "fog_transmittance.R", "fog_transmittance.G", "fog_transmittance.B"})
    ASSERT_TRUE(image->find(name)) << name;
  for (size_t i = 0; i < image->find("fog.R")->f.size(); ++i) {
    light += image->find("fog.R")->f[i];
    clear[0] += image->find("fog_transmittance.R")->f[i], clear[1] += image->find("fog_transmittance.B")->f[i];
  }
  EXPECT_GT(light, 0);
  EXPECT_GT(clear[0], clear[1]);
  EXPECT_GT(clear[1], 0);
  // Another look is another picture: a state does not go on with it.
  const std::vector<std::string> state = {"--look", look, "--state", folder / "s", "--resume", "--spp", "2"};
  EXPECT_EQ(candela(traced(folder / "a.exr", state)).code, 0);
  std::ofstream(look) << R"({"fog": {"extinction": [0.1, 0.2, 0.4], "albedo": 0.5}})";
  EXPECT_EQ(candela(traced(folder / "a.exr", state)).code, 3);

  std::ofstream(look) << R"({"fog": {"extinction": -1}})";
  const Ended wrong = candela(traced(folder / "x.exr", {"--look", look}));
  EXPECT_EQ(wrong.code, 3);
  EXPECT_NE(wrong.err.find("look.json: /fog/extinction: -1 is below 0"), std::string::npos) << wrong.err;
  EXPECT_EQ(candela(traced(folder / "x.exr", {"--look", folder / "none.json"})).code, 3);
}

// A picture whose knobs leave the sun's disc out says so.
TEST(Reference, RendersDoNotLeaveTheSunsDiscOutInSilence) {
  const TestFolder folder;
  const std::string look = folder / "look.json", left_out = "is left out";
  std::ofstream(look) << R"({"fog": {"extinction": 0.1}, "sun": {}})";
  for (const std::string command : {"render", "plan", "sequence"}) {
    std::vector<std::string> words = {command,  box,  "--set", "sun.soft=hard",     "--size", "16x12",
                                      "--look", look, "-o",    folder / "a%04d.exr"};
    if (command == "sequence") words.insert(words.end(), {"--frames", "0-1"});
    const Ended ended = candela(words);
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_NE(ended.err.find(left_out), std::string::npos) << command << ended.err;
    words.push_back("--strict");
    const Ended strict = candela(words);
    EXPECT_EQ(strict.code, 3) << command;
    EXPECT_NE(strict.err.find(left_out), std::string::npos) << strict.err;
  }
  const Ended json = candela(
      {"render", box, "--set", "sun.soft=hard", "--size", "16x12", "--look", look, "-o", folder / "b.exr", "--json"});
  EXPECT_NE(nlohmann::json::parse(json.out)["warnings"].dump().find(left_out), std::string::npos) << json.out;
  const Ended soft = candela({"render", box, "--size", "16x12", "--look", look, "-o", folder / "b.exr"});
  EXPECT_EQ(soft.err.find(left_out), std::string::npos) << soft.err;
  std::ofstream(look) << R"({"fog": {"extinction": 0.1}})";
  const Ended empty = candela({"render", box, "--size", "16x12", "--look", look, "-o", folder / "b.exr"});
  EXPECT_EQ(empty.code, 0);
  EXPECT_EQ(empty.err.find(left_out), std::string::npos) << empty.err;
}

TEST(Reference, NamesWhatIsWrong) {
  const TestFolder folder;
  const std::string out = folder / "x.exr";
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"reference", box}, "-o"},
      {{"reference"}, "SCENE"},
      {{"reference", box, "-o", out, "--mode", "paths"}, "did you mean 'path'"},
      {{"reference", box, "-o", out, "--bvh", "sahh"}, "did you mean 'sah'"},
      {{"reference", box, "-o", out, "--set", "bvh.bucket=12"}, "did you mean 'bvh.buckets'"},
      {{"reference", box, "-o", out, "--set", "bvh.buckets=1"}, "from 2 to 64"},
      {{"reference", box, "-o", out, "--set", "bvh.max-leaf=1.5"}, "whole number"},
      {{"reference", box, "-o", out, "--sampler", "random"}, "jittered"},
      {{"reference", box, "-o", out, "--sampler", "uniform", "--seconds", "1"}, "--spp"},
      {{"reference", box, "-o", out, "--resume"}, "--state"},
      {{"reference", box, "-o", out, "--mode", "path", "--visibility", "off"}, "--visibility"},
      {{"reference", box, "-o", out, "--mode", "path", "--ambient", "occlusion"}, "--ambient"},
      {{"reference", box, "-o", out, "--bounces", "3"}, "--bounces"},
      {{"reference", box, "-o", out, "--fog-steps", "4"}, "--look"},
      {{"reference", box, "-o", out, "--look", "l.json", "--fog-steps", "0"}, "--fog-steps"},
      {{"reference", box, "-o", out, "--fog-lights", "4"}, "--look"},
      {{"reference", box, "-o", out, "--look", "l.json", "--fog-lights", "4097"}, "--fog-lights"},
      {{"reference", box, "-o", out, "--look", "l.json", "--mode", "path", "--fog-steps", "4"}, "--fog-steps"},
      {{"reference", box, "-o", out, "--view", "fogs"}, "did you mean 'fog'"},
      {{"reference", box, "-o", out, "--noise", "-1"}, "--noise"},
      {{"reference", box, "-o", out, "--spp", "-1"}, "--spp"},
      {{"reference", box, "-o", out, "--layers", "depht"}, "did you mean 'depth'"},
      {{"reference", box, "-o", out, "--view", "debug.a.b"}, "--view"},
      {{"reference", box, "-o", out, "--view", "occlusoin"}, "did you mean 'occlusion'"},
      {{"reference", box, "-o", out, "--technique", "forward"}, "--technique"},
      {{"reference", box, "-o", folder / "x.jpg"}, ".exr nor .png"},
  };
  for (const auto& [words, named] : cases) {
    const Ended ended = candela(words);
    EXPECT_EQ(ended.code, 2) << named;
    EXPECT_NE(ended.err.find(named), std::string::npos) << ended.err;
  }
  EXPECT_EQ(candela({"reference", folder / "none.glb", "-o", out}).code, 3);
  EXPECT_TRUE(files_in(folder.path()).empty());
}

// Techniques show the picture behind glass, direct light takes it as opaque, and both say so; paths follow light
// through it, and there is nothing to say. A file may require it.
TEST(Reference, OnlyPathsFollowLightThroughGlass) {
  const TestFolder folder;
  const std::string file = folder / "pane.gltf";
  const auto write = [&](const char* required) {
    std::ofstream(file) << R"({"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_materials_transmission"],)"
                        << required << R"("scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
      "materials": [{"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
      "bufferViews": [{"buffer": 0, "byteLength": 36}],
      "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
  };
  const auto traced_in = [&](const char* mode) {
    return candela({"reference", file, "--mode", mode, "--size", "8x8", "--spp", "1", "-o",
                    folder / (std::string(mode) + ".exr")});
  };
  for (const char* required : {"", R"("extensionsRequired": ["KHR_materials_transmission"],)"}) {
    write(required);
    const Ended drawn = candela({"plan", file}), direct = traced_in("direct"), path = traced_in("path");
    EXPECT_EQ(drawn.code, 0) << drawn.err;
    EXPECT_NE(drawn.err.find("approximated: the picture behind the surface"), std::string::npos) << drawn.err;
    EXPECT_EQ(direct.code, 0) << direct.err;
    EXPECT_NE(direct.err.find("approximated: direct light takes the surface as opaque"), std::string::npos)
        << direct.err;
    EXPECT_EQ(path.code, 0) << path.err;
    EXPECT_EQ(path.err.find("KHR_materials_transmission"), std::string::npos) << path.err;
  }
}

}  // namespace candela::test
