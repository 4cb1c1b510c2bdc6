#include <gtest/gtest.h>

#include <csignal>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

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
  const Ended ended = candela({"reference", spheres, "--size", "24x16", "--spp", "4", "-o", folder / "a.exr", "-o", folder / "a.png",
                               "--layers", "variance,heatmap.traversal,heatmap.leaves", "--frame", "3", "--json"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  const auto json = nlohmann::json::parse(ended.out);
  EXPECT_EQ(json["spp"], 4);
  EXPECT_EQ(json["reference"]["mode"], "direct");
  EXPECT_GT(json["bvh"]["triangles"], 0);
  const auto image = read_image(folder / "a.exr");
  ASSERT_TRUE(image);
  for (const char* name : {"R", "A", "variance.G", "heatmap.traversal.Y", "heatmap.leaves.Y"}) EXPECT_TRUE(image->find(name)) << name;
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
  const Ended other = candela(traced(folder / "other.exr", {"--spp", "10", "--state", folder / "s", "--resume", "--seed", "2"}));
  EXPECT_EQ(other.code, 3);
  EXPECT_NE(other.err.find("another picture"), std::string::npos) << other.err;
}

// An interruption leaves whole batches, and what they are made into is what as many samples are at once.
TEST(Reference, AnInterruptionLeavesAStateToGoOnFrom) {
  const TestFolder folder;
  std::vector<std::string> words = traced(folder / "never.exr", {"--spp", "1000000", "--state", folder / "s"});
  ASSERT_TRUE(candela_killed_after(words, 700, SIGINT));
  EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{"s"});
  words = {"reference", spheres, "--size", "24x16", "-o", folder / "a.exr", "--quiet", "--state", folder / "s", "--resume", "--spp", "2", "--json"};
  const Ended resumed = candela(words);
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  const uint64_t spp = nlohmann::json::parse(resumed.out)["spp"];
  EXPECT_EQ(candela(traced(folder / "b.exr", {"--spp", std::to_string(spp)})).code, 0);
  EXPECT_EQ(bytes_of(folder / "a.exr"), bytes_of(folder / "b.exr"));
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
  std::vector<std::string> words = {"reference", folder / "bright.glb", "--size", "64x36", "--spp", "2", "-o", folder / "x.exr", "--quiet"};
  const Ended ended = candela(words);
  EXPECT_EQ(ended.code, 7) << ended.err;
  EXPECT_NE(ended.err.find("first at x"), std::string::npos) << ended.err;
  EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{"bright.glb"});
  words.push_back("--allow-nonfinite");
  EXPECT_EQ(candela(words).code, 0);
}

TEST(Reference, NamesWhatIsWrong) {
  const TestFolder folder;
  const std::string out = folder / "x.exr";
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"reference", box}, "-o"},
      {{"reference"}, "SCENE"},
      {{"reference", box, "-o", out, "--mode", "paths"}, "did you mean 'path'"},
      {{"reference", box, "-o", out, "--bvh", "sahh"}, "did you mean 'sah'"},
      {{"reference", box, "-o", out, "--sampler", "random"}, "jittered"},
      {{"reference", box, "-o", out, "--sampler", "uniform", "--seconds", "1"}, "--spp"},
      {{"reference", box, "-o", out, "--resume"}, "--state"},
      {{"reference", box, "-o", out, "--mode", "path", "--visibility", "off"}, "--visibility"},
      {{"reference", box, "-o", out, "--mode", "path", "--ambient", "occlusion"}, "--ambient"},
      {{"reference", box, "-o", out, "--bounces", "3"}, "--bounces"},
      {{"reference", box, "-o", out, "--noise", "-1"}, "--noise"},
      {{"reference", box, "-o", out, "--spp", "-1"}, "--spp"},
      {{"reference", box, "-o", out, "--layers", "depth"}, "variance"},
      {{"reference", box, "-o", out, "--view", "leaves"}, "heatmap.leaves"},
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

// Techniques and direct light draw glass opaque and say so; paths go through it, and there is nothing to say.
TEST(Reference, OnlyPathsGoThroughGlass) {
  const TestFolder folder;
  const std::string file = folder / "pane.gltf";
  const auto write = [&](const char* required) {
    std::ofstream(file) << R"({"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_materials_transmission"],)" << required
                        << R"("scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
      "materials": [{"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
      "bufferViews": [{"buffer": 0, "byteLength": 36}],
      "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
  };
  const auto traced_in = [&](const char* mode) {
    return candela({"reference", file, "--mode", mode, "--size", "8x8", "--spp", "1", "-o", folder / (std::string(mode) + ".exr")});
  };
  const std::string note = "KHR_materials_transmission is ignored: the surface is drawn opaque";
  write("");
  for (const Ended& ended : {candela({"plan", file}), traced_in("direct")}) {
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_NE(ended.err.find(note), std::string::npos) << ended.err;
  }
  const Ended path = traced_in("path");
  EXPECT_EQ(path.code, 0) << path.err;
  EXPECT_EQ(path.err.find("KHR_materials_transmission"), std::string::npos) << path.err;
  write(R"("extensionsRequired": ["KHR_materials_transmission"],)");
  for (const Ended& ended : {candela({"plan", file}), traced_in("direct")}) {
    EXPECT_EQ(ended.code, 3);
    EXPECT_NE(ended.err.find("--mode path"), std::string::npos) << ended.err;
  }
  EXPECT_EQ(traced_in("path").code, 0);
}

}  // namespace candela::test
