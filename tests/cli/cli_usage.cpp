#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "program.h"

namespace candela::test {
namespace {

using Json = nlohmann::json;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Help, NamesEveryCommandAndExitCode) {
  const Ended help = candela({"--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_EQ(help.err, "");
  for (const char* word : {"render", "sequence", "plan", "facts", "compare", "golden", "reference", "make-scene",
                           "list", "--version", "Exit codes", "non-finite"})
    EXPECT_TRUE(contains(help.out, word)) << word;
}

// The parser must take every option that the help shows, and show every one that the documents promise.
TEST(Help, ListsEveryOption) {
  const std::vector<std::string> job = {"--fps",
                                        "--animation",
                                        "--camera",
                                        "--eye",
                                        "--target",
                                        "--yfov",
                                        "--size",
                                        "--samples",
                                        "--technique",
                                        "--quality",
                                        "--set",
                                        "--sky",
                                        "--exposure",
                                        "--tonemap",
                                        "--layers",
                                        "--background",
                                        "--seed",
                                        "--exr-type",
                                        "--exr-compression",
                                        "--png-bits",
                                        "--no-dither",
                                        "--metadata-timings",
                                        "--allow-nonfinite",
                                        "--strict",
                                        "--config",
                                        "--quiet",
                                        "--verbose"};
  const std::map<std::string, std::vector<std::string>> own = {
      {"render",
       {"--frame", "--time", "-o,--output", "--timings", "--trace", "--overlap", "--check-determinism", "--device",
        "--validate", "--shader-dir", "--queues", "--json"}},
      {"sequence",
       {"--frames", "-o,--output", "--video", "--audio", "--resume", "--in-flight", "--shard", "--timings", "--trace",
        "--device", "--queues", "--json"}},
      {"plan", {"--frame", "--time", "--json", "--dot"}}};
  for (const auto& [command, options] : own) {
    const Ended help = candela({command, "--help"});
    EXPECT_EQ(help.code, 0);
    for (const auto* list : {&job, &options})
      for (const std::string& option : *list)
        EXPECT_TRUE(contains(help.out, "  " + option)) << command << " " << option;
  }
}

// What decides what is there, and nothing of the picture, which a file for several commands may say all the same.
TEST(Help, FactsTakesWhatDecidesThem) {
  const std::string help = candela({"facts", "--help"}).out;
  for (const char* option : {"scene", "--camera", "--size", "--effects", "--quality", "--sky", "--look", "--variant",
                             "--cut-outs", "--frame", "--time", "--strict", "--config", "--json"})
    EXPECT_TRUE(contains(help, "  " + std::string(option))) << option;
  for (const char* option : {"--png-bits", "--exposure", "--technique", "--layers", "--set", "--dither", "--output"})
    EXPECT_FALSE(contains(help, option)) << option;
  const std::string file = scene("spheres"), config = ::testing::TempDir() + "candela_facts.toml";
  std::ofstream(config) << "png-bits = 16\nquality = \"draft\"\n";
  EXPECT_EQ(candela({"facts", file, "--config", config}).code, 0);
  std::ofstream(config) << "png-bitz = 16\n";
  EXPECT_EQ(candela({"facts", file, "--config", config}).code, 3);
}

// Long lists are found by group; what is left in the first is the help alone.
TEST(Help, OptionsStandInGroupsWithExamplesBelow) {
  for (const char* command : {"render", "sequence", "reference", "plan", "watch"}) {
    const std::string help = candela({command, "--help"}).out;
    for (const char* group : {"\nMoment:\n", "\nCamera:\n", "\nPicture:\n", "\nLight and look:\n", "\nExamples:\n"})
      EXPECT_TRUE(contains(help, group)) << command << group;
    const size_t options = help.find("\nOptions:\n"), next = help.find("\n\n", options);
    const std::string first = help.substr(options, next - options);
    EXPECT_EQ(std::count(first.begin(), first.end(), '\n'), 3) << first;
    EXPECT_FALSE(contains(help, "Env:")) << command;
  }
}

TEST(List, SaysALineAboutEachName) {
  for (const char* what : {"techniques", "layers", "views", "scenes"}) {
    std::istringstream lines(candela({"list", what}).out);
    int count = 0;
    for (std::string line; std::getline(lines, line); ++count)
      EXPECT_NE(line.find("  "), std::string::npos) << what << ": " << line;
    EXPECT_GT(count, 2) << what;
  }
  const std::string techniques = candela({"list", "techniques"}).out;
  EXPECT_EQ(techniques.find("auto "), 0u) << techniques;
  EXPECT_EQ(techniques.find("default", techniques.find("default") + 1), std::string::npos) << techniques;
}

// Each example of the help must be taken by the parser: all that is wrong with it is that its files are not there.
TEST(Help, ExamplesAreTaken) {
  for (const char* command : {"render", "sequence", "reference", "plan", "compare", "sheet", "tune"}) {
    std::istringstream help(candela({command, "--help"}).out);
    int examples = 0;
    for (std::string line; std::getline(help, line);) {
      if (!line.starts_with("  candela ")) continue;
      std::erase(line, '\'');
      std::istringstream words(line.substr(10, line.find_first_of("|>") - 10));
      std::vector<std::string> arguments;
      for (std::string word; words >> word;) arguments.push_back(word);
      const TestFolder folder;
      const Ended ended = candela(arguments, folder.path());
      EXPECT_EQ(ended.code, 3) << line << "\n" << ended.err;
      ++examples;
    }
    EXPECT_GT(examples, 0) << command;
  }
}

TEST(Help, VersionIsOneLineOnStdout) {
  const Ended version = candela({"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_TRUE(version.out.starts_with("candela "));
  EXPECT_EQ(std::count(version.out.begin(), version.out.end(), '\n'), 1);
}

TEST(Help, VersionAsJsonSaysWhatWasBuiltIn) {
  const Ended version = candela({"--version", "--json"});
  ASSERT_EQ(version.code, 0) << version.err;
  const Json j = Json::parse(version.out);
  EXPECT_TRUE(contains(candela({"--version"}).out, "candela " + j["version"].get<std::string>()));
  EXPECT_TRUE(contains(candela({"--version"}).out, j["source"].get<std::string>()));
  EXPECT_EQ(j["build"]["libraries_linked"], "shared");
  for (const char* library : {"OpenEXR", "libdeflate", "fmt", "glm", "glslang", "oneTBB"})
    EXPECT_TRUE(contains(j["libraries"].value(library, ""), ".")) << library;
  for (const auto& [name, module] : j["modules"].items())
    EXPECT_TRUE(module["opens"]) << name << ": " << module["reason"];
  EXPECT_EQ(candela({"--json"}).code, 2);
}

struct Refusal {
  std::vector<std::string> arguments;
  std::string says;
};

TEST(Usage, EveryRefusalIsExitTwoAndNamesTheOption) {
  const std::string box = scene("unlit-box");
  const std::vector<Refusal> refusals = {
      {{}, "no command"},
      {{"rendr", box}, "did you mean 'render'"},
      {{"render"}, "SCENE"},
      {{"render", box}, "-o"},
      {{"render", box, "-o", "x.jpg"}, ".exr nor .png"},
      {{"sequence", box, "--frames", "0-9", "-o", "%04d.webp"}, "convert a PNG"},
      {{"render", box, "-o", "x.exr", "--sise", "1x1"}, "did you mean '--size'"},
      {{"render", box, "-o", "x.exr", "--size", "12"}, "--size"},
      {{"render", box, "-o", "x.exr", "--size", "0x5"}, "--size"},
      {{"render", box, "-o", "x.exr", "--tonemap", "agxx"}, "did you mean 'agx'"},
      {{"render", box, "-o", "x.exr", "--technique", "none"}, "brute-force"},
      {{"render", box, "-o", "x.exr", "--layers", "deep"}, "depth"},
      {{"render", box, "-o", "x.exr", "--set", "cull"}, "PASS.KNOB=VALUE"},
      {{"render", box, "-o", "x.exr", "--set", "nothing.x=1"}, "nothing"},
      {{"render", box, "-o", "x.exr", "--samples", "3"}, "--samples"},
      {{"render", box, "-o", "x.png", "--view", "heatmap.light"}, "did you mean 'heatmap_lights'"},
      {{"render", box, "-o", "x.png", "--set", "lights.test=box"}, "capsule-joint"},
      {{"render", box, "-o", "x.png", "--set", "lights.slices_per_octave=3"}, "1, 2, 4, 8 or 16"},
      {{"render", box, "-o", "x.exr", "--samples", "4", "--set", "resolve.samples=1"}, "contradicts --samples 4"},
      {{"render", box, "-o", "x.exr", "--samples", "many"}, "--samples"},
      {{"render", box, "-o", "x.exr", "--eye", "1,2,3"}, "--target"},
      {{"render", box, "-o", "x.exr", "--eye", "1,2", "--target", "0,0,0"}, "--eye"},
      {{"render", box, "-o", "x.exr", "--frame", "1", "--time", "2"}, "--time"},
      {{"render", box, "-o", "x.exr", "--fps", "0"}, "--fps"},
      {{"render", box, "-o", "x.exr", "--frames", "0-3"}, "several pictures"},
      {{"render", box, "-o", "####.exr", "--frames", "0-3", "--frame", "1"}, "--frames"},
      {{"render", box, "-o", "####.exr", "--frames", "0-3", "--timings", "-"}, "--timings"},
      {{"render", box, "-o", "{camera}.exr"}, "--camera all"},
      {{"render", box, "-o", "{frme}.exr"}, "{frame:04}"},
      {{"render", box, "-o", "x.exr", "--azimuth", "3", "--camera", "0"}, "--azimuth"},
      {{"render", box, "-o", "x.exr", "--elevation", "91"}, "--elevation"},
      {{"render", box, "-o", "x.exr", "--fit", "--eye", "1,2,3", "--target", "0,0,0"}, "--fit"},
      {{"render", box, "-o", "x.exr", "--turntable", "0"}, "--turntable"},
      {{"render", box, "-o", "x.exr", "--exr-compression", "lz4"}, "--exr-compression"},
      {{"render", box, "-o", "x.exr", "-o", "x.exr"}, "twice"},
      {{"render", box, "-o", "x.exr", "--json", "--timings", "-"}, "--timings"},
      {{"render", box, "-o", "x.exr", "--timings", "-", "--trace", "-"}, "--trace"},
      {{"render", box, "-o", "x.exr", "--trace", "-", "--json"}, "--trace"},
      {{"render", box, "-o", "x.png", "--layers", "depth"}, "layers need an EXR output"},
      {{"render", box, "-o", "x.exr", "--frame", "99999999999999999999"}, "--frame"},
      {{"render", box, "-o", "x.exr", "--seed", "-1"}, "--seed"},
      {{"render", box, "-o", "x.exr", "--timeout", "0"}, "--timeout"},
      {{"render", box, "-o", "x.exr", "--timeout", "-5"}, "--timeout"},
      {{"render", box, "-o", "x.exr", "--timeout", "nan"}, "--timeout"},
      {{"render", box, "-o", "x.exr", "--queues", "3"}, "--queues"},
      {{"render", box, "-o", "x.exr", "--overlap"}, "--timings"},
      {{"sequence", box, "--frames", "0-9", "-o", "%04d.exr", "--in-flight", "-1"}, "--in-flight"},
      {{"sequence", box, "--frames", "0-9", "-o", "%04d.exr", "--encoders", "257"}, "--encoders"},
      {{"render", box, "-o", "x.exr", "--check-determinism", "0"}, "--check-determinism"},
      {{"render", box, "-o", "x.exr", "--shader-dir", "nowhere"}, "--shader-dir"},
      {{"render", box, "-o", "x.exr", "--shader-dir", box}, "--shader-dir"},
      {{"sequence", box, "-o", "%04d.exr"}, "--frames"},
      {{"sequence", box, "--frames", "0-9", "-o", "out/%04d.png", "--layers", "depth"}, "layers need an EXR output"},
      {{"sequence", box, "--frames", "0-9", "-o", "%04d.exr", "--timings", "-", "--trace", "-"}, "--trace"},
      {{"sequence", box, "--frames", "0-9", "-o", "out/%04d.exr", "--timeout", "0"}, "--timeout"},
      {{"sequence", box, "--frames", "0-9"}, "-o"},
      {{"sequence", box, "--frames", "0-9", "-o", "x.exr"}, "%04d"},
      {{"sequence", box, "--frames", "0-9", "-o", "%04d.exr", "--shard", "3/2"}, "--shard"},
      {{"sequence", box, "--frames", "0-9", "-o", "%04d.exr", "-o", "./%04d.exr"}, "twice"},
      {{"sequence", box, "--frames", "0-9", "-o", "%04d.exr", "--audio", "a.wav"}, "--video"},
      {{"compare", "a.png"}, "two images"},
      {{"sheet", "-o", "x.png"}, "PICTURE"},
      {{"sheet", "a.png"}, "-o"},
      {{"sheet", "a.png", "-o", "x.exr"}, ".png"},
      {{"sheet", "a.png", "-o", "x.png", "--tile", "4x4"}, "--tile"},
      {{"sheet", "a.png", "-o", "x.png", "--crop", "1,2"}, "--crop"},
      {{"compare", "a.png", "b.png", "--limit", "flap=1"}, "flip"},
      {{"list", "things"}, "things"},
      {{"make-scene", "nosuch", "-o", "x.glb"}, "nosuch"},
      {{"make-scene", "spheres", "-o", "x.gltf"}, ".glb"},
      {{"make-scene", "spheres", "-o", "x.glb", "--seed", "-1"}, "--seed"},
      {{"golden", "update"}, "--why"},
  };
  TestFolder folder;
  for (const Refusal& refusal : refusals) {
    const Ended ended = candela(refusal.arguments, folder.path());
    std::string line = "candela";
    for (const std::string& argument : refusal.arguments) line += " " + argument;
    EXPECT_EQ(ended.code, 2) << line << "\n" << ended.err;
    EXPECT_EQ(ended.out, "") << line;
    EXPECT_TRUE(contains(ended.err, refusal.says)) << line << "\n" << ended.err;
  }
  EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{});
}

TEST(Input, MissingAndMalformedScenesAreExitThree) {
  TestFolder folder;
  std::ofstream(folder / "noise.glb") << "this is not a scene";
  for (const std::string& file :
       {folder / "missing.glb", folder / "noise.glb", folder.path().string(), std::string("/dev/zero")}) {
    const Ended ended = candela({"render", file, "-o", folder / "out.exr"});
    EXPECT_EQ(ended.code, 3) << file << "\n" << ended.err;
    EXPECT_TRUE(contains(ended.err, file)) << ended.err;
  }
  EXPECT_EQ(candela({"plan", folder / "missing.glb"}).code, 3);
  EXPECT_EQ(candela({"compare", folder / "a.png", folder / "b.png"}).code, 3);
  EXPECT_EQ(candela({"render", scene("unlit-box"), "-o", folder / "out.exr", "--config", folder / "none.toml"}).code,
            3);
  EXPECT_EQ(files_in(folder.path()), std::vector<std::string>{"noise.glb"});
}

TEST(Device, AnUnknownOneIsExitFourAndListsWhatThereIs) {
  TestFolder folder;
  const Ended ended = candela({"render", scene("unlit-box"), "-o", folder / "out.exr", "--device", "nosuch"});
  EXPECT_EQ(ended.code, 4) << ended.err;
  EXPECT_TRUE(contains(ended.err, "nosuch")) << ended.err;
}

TEST(Stdout, IsCleanJson) {
  const std::string box = scene("unlit-box");
  TestFolder folder;
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"list", "devices", "--json"},
           {"list", "techniques", "--json"},
           {"list", "passes", "--json"},
           {"list", "knobs", "--json"},
           {"list", "layers", "--json"},
           {"list", "scenes", "--json"},
           {"plan", box, "--json"},
           {"facts", box, "--json"},
           {"render", box, "-o", folder / "a.exr", "--size", "16x16", "--json"},
           {"render", box, "-o", folder / "a.exr", "--size", "16x16", "--timings", "-"},
           {"render", box, "-o", folder / "a.exr", "--size", "16x16", "--queues", "1", "--overlap", "--json"},
           {"render", box, "--check-determinism", "2", "--size", "16x16", "--json"},
           {"sequence", box, "--frames", "0-1", "-o", folder / "%04d.exr", "--size", "16x16", "--json"},
           {"compare", folder / "a.exr", folder / "a.exr", "--json"}}) {
    const Ended ended = candela(arguments);
    EXPECT_EQ(ended.code, 0) << arguments[0] << " " << arguments[1] << "\n" << ended.err;
    EXPECT_TRUE(Json::accept(ended.out)) << arguments[0] << " " << arguments[1] << "\n" << ended.out;
  }
}

TEST(Config, GivesTheSameJobAsTheOptionsAndYieldsToThem) {
  TestFolder folder;
  std::ofstream(folder / "job.toml")
      << "scene = \"" << scene("unlit-box") << "\"\n"
      << "size = \"24x12\"\nsamples = 1\ntonemap = \"aces\"\nexposure = -1.5\nlayers = \"depth,normal\"\n"
      << "eye = \"-1,2,3\"\ntarget = \"0,0,0\"\nyfov = 30\nno-dither = true\nseed = 7\noutput = [\"a.exr\"]\n"
      << "[plan]\npng-bits = 16\n";
  const Ended from_file = candela({"render", "--config", folder / "job.toml", "--json", "--seed", "9"}, folder.path());
  ASSERT_EQ(from_file.code, 0) << from_file.err;
  const Ended from_options = candela({"render",      scene("unlit-box"),
                                      "--size",      "24x12",
                                      "--samples",   "1",
                                      "--tonemap",   "aces",
                                      "--exposure",  "-1.5",
                                      "--layers",    "depth,normal",
                                      "--eye",       "-1,2,3",
                                      "--target",    "0,0,0",
                                      "--yfov",      "30",
                                      "--no-dither", "--seed",
                                      "9",           "-o",
                                      "b.exr",       "--json"},
                                     folder.path());
  ASSERT_EQ(from_options.code, 0) << from_options.err;
  EXPECT_EQ(Json::parse(from_file.out)["job"], Json::parse(from_options.out)["job"]);
  EXPECT_EQ(bytes_of(folder / "a.exr"), bytes_of(folder / "b.exr"));

  std::ofstream(folder / "slip.toml") << "sise = \"24x12\"\n";
  const Ended slip = candela({"render", "--config", folder / "slip.toml"}, folder.path());
  EXPECT_EQ(slip.code, 3);
  EXPECT_TRUE(contains(slip.err, "did you mean 'size'")) << slip.err;
}

}  // namespace
}  // namespace candela::test
