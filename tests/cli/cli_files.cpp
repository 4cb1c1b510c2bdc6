#include <gtest/gtest.h>
#include <sys/mount.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "image/io.h"
#include "program.h"

namespace candela::test::cli_files {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

Arguments sequence(const std::string& pattern, const Arguments& more = {}) {
  Arguments arguments = {"sequence", scene("animated"), "--frames", "0-9", "--size", "64x36", "-o", pattern, "--quiet"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const std::string& name : files_in(folder)) files[name] = bytes_of(folder / name);
  return files;
}

TEST(Render, WritesWhatItSays) {
  TestFolder folder;
  const Ended ended =
      candela({"render", scene("animated"), "-o", folder / "deep/er/a.exr", "-o", folder / "a_####.png", "--frame",
               "12", "--size", "48x27", "--layers", "depth,normal,albedo,object_id,material_id,emission,direct",
               "--json", "--timings", folder / "t.json", "--trace", folder / "trace.json"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json j = Json::parse(ended.out);
  EXPECT_EQ(j["outputs"].size(), 2u);
  EXPECT_EQ(j["frame"], 12);
  EXPECT_EQ(j["time_s"], 0.5);
  EXPECT_FALSE(j["device"]["name"].get<std::string>().empty());
  EXPECT_NE(ended.err.find(j["device"]["name"].get<std::string>()), std::string::npos);
  EXPECT_EQ(j["plan_hash"].get<std::string>().size(), 32u);
  EXPECT_EQ(files_in(folder.path()), (Arguments{"a_0012.png", "deep", "t.json", "trace.json"}));

  const auto exr = read_image(folder / "deep/er/a.exr");
  ASSERT_TRUE(exr) << exr.error().text();
  for (const char* name : {"R", "G", "B", "A", "depth.Z", "normal.X", "normal.Y", "normal.Z", "albedo.R", "object_id.X",
                           "material_id.X", "emission.B", "direct.G"})
    EXPECT_NE(exr->find(name), nullptr) << name;
  std::map<std::string, MetadataEntry> metadata;
  for (const MetadataEntry& entry : exr->metadata) metadata[entry.name] = entry;
  EXPECT_EQ(metadata["worldToCamera"].matrix.size(), 16u);
  EXPECT_EQ(metadata["candela:frame"].text, "12");
  EXPECT_EQ(metadata["framesPerSecond"].number, 24);
  Json job = j["job"];
  job["scene"] = fs::path(job["scene"].get<std::string>()).filename().string();  // of absolute paths the file's name
  EXPECT_EQ(Json::parse(metadata["candela:job"].text), job);
  EXPECT_EQ(metadata["candela:plan"].text, j["plan_hash"]);
  EXPECT_FALSE(metadata.contains("candela:timings"));

  const Json timings = Json::parse(bytes_of(folder / "t.json"));
  for (const char* stage : {"load", "decode", "upload", "animate", "light_grid", "sun_shadows", "local_shadows",
                            "trees", "plan", "compile", "allocate", "record", "wait", "read_back", "encode"})
    EXPECT_TRUE(timings["cpu_ms"].contains(stage)) << stage;
  double sum = 0;
  for (const auto& [pass, milliseconds] : timings["gpu_ms"].items()) sum += milliseconds.get<double>();
  EXPECT_GT(sum, 0);
  EXPECT_GT(timings["memory"]["process_peak_bytes"], 1000000);
  EXPECT_GT(timings["uploaded_bytes"]["opening"], 0);
  EXPECT_GT(timings["uploaded_bytes"]["frames"], 0);
  EXPECT_FALSE(Json::parse(bytes_of(folder / "trace.json"))["traceEvents"].empty());
}

// Any image of the plan; the frame's own file stays byte for byte what it is.
TEST(Render, DumpsImagesOfThePlan) {
  TestFolder folder;
  const Arguments plain = {"render", scene("spheres"), "--size", "40x24", "--samples", "4", "--quiet"};
  const auto with = [&](const Arguments& more) {
    Arguments arguments = plain;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return candela(arguments);
  };
  ASSERT_EQ(with({"-o", folder / "plain.exr"}).code, 0);
  const Ended ended = with({"-o", folder / "a.exr", "--dump", "resolve.resolved", "--dump",
                            "depth_views.sun.sun.maps[0,1]=" + (folder / "deep/map.exr"), "--json"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(bytes_of(folder / "a.exr"), bytes_of(folder / "plain.exr"));
  EXPECT_EQ(Json::parse(ended.out)["dumps"].size(), 2u);
  const auto resolved = read_image(folder / "a.resolve.resolved.exr"), map = read_image(folder / "deep/map.exr");
  ASSERT_TRUE(resolved && map);
  EXPECT_EQ(resolved->width, 40);
  EXPECT_NE(resolved->find("A"), nullptr);
  EXPECT_NE(map->find("Z"), nullptr);
  // Alone, without -o.
  ASSERT_EQ(with({"--dump", "resolve.resolved=" + (folder / "alone.exr")}).code, 0);
  EXPECT_EQ(bytes_of(folder / "alone.exr"), bytes_of(folder / "a.resolve.resolved.exr"));
  for (const auto& [dump, word] :
       std::vector<std::pair<std::string, std::string>>{{"resolve.resolvd", "resolve.resolved"},
                                                        {"resolve", "PASS.IMAGE"},
                                                        {"resolve.resolved[0,9]", "1 layer"},
                                                        {"resolve.resolved=" + (folder / "a.png"), ".exr"},
                                                        {"resolve.resolved=" + (folder / "b.exr"), "twice"}}) {
    const Ended refused = with({"-o", folder / "b.exr", "--dump", dump});
    EXPECT_EQ(refused.code, 2) << dump;
    EXPECT_NE(refused.err.find(word), std::string::npos) << refused.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "b.exr"));
  }
  EXPECT_EQ(with({"--dump", "resolve.resolved"}).code, 2);
}

// What frames keep for later ones shows in no byte, in one run or in shards.
TEST(Sequence, KeptShadowMapsChangeNoByte) {
  TestFolder folder;
  const auto films = [&](const std::string& name, const Arguments& more) {
    Arguments arguments = {"sequence", scene("spheres"), "--frames",        "0-5", "--size",
                           "48x27",    "--set",          "sun.size_px=512", "-o",  folder / (name + "/%04d.exr"),
                           "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Ended ended = candela(arguments);
    EXPECT_EQ(ended.code, 0) << ended.err;
  };
  films("off", {"--cache", "off"});
  films("on", {});
  films("flight", {"--cache", "on", "--in-flight", "3"});
  for (const char* shard : {"2/2", "1/2"}) films("shards", {"--shard", shard});
  const auto off = contents(folder / "off");
  EXPECT_EQ(off.size(), 6u);
  for (const char* other : {"on", "flight", "shards"}) EXPECT_EQ(contents(folder / other), off) << other;
}

// A trace changes no byte and no order: each frame has one span on the device, which begins once it was handed over and
// after the frame before has ended.
TEST(Sequence, TracesFramesAsTheyRun) {
  const TestFolder folder;
  const auto film = [&](const std::string& into, const Arguments& more) {
    Arguments words = {"sequence", scene("animated"),         "--frames", "0-3", "--size", "32x18", "--quiet",
                       "-o",       folder / (into + "%d.png")};
    words.insert(words.end(), more.begin(), more.end());
    ASSERT_EQ(candela(words).code, 0);
  };
  film("plain", {});
  film("traced", {"--trace", folder / "t.json"});
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(bytes_of(folder / fmt::format("plain{}.png", i)), bytes_of(folder / fmt::format("traced{}.png", i))) << i;
  std::map<std::string, std::vector<std::pair<double, double>>> spans;  // start and end
  const Json trace = Json::parse(bytes_of(folder / "t.json"));
  for (const Json& event : trace["traceEvents"])
    if (event["ph"] == "X")
      spans[event["name"]].emplace_back(event["ts"], event["ts"].get<double>() + event["dur"].get<double>());
  ASSERT_EQ(spans["frame"].size(), 4u);
  ASSERT_EQ(spans["record and submit"].size(), 4u);
  ASSERT_EQ(spans["wait"].size(), 4u);
  EXPECT_EQ(spans["encode"].size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_LT(spans["frame"][i].first, spans["frame"][i].second) << i;
    EXPECT_GE(spans["frame"][i].first, spans["record and submit"][i].first) << i;
    EXPECT_LT(spans["frame"][i].first, spans["wait"][i].second) << i;
    if (i > 0) {
      EXPECT_GE(spans["frame"][i].first, spans["frame"][i - 1].second) << i;
    }
  }
}

// OpenEXR's rule: a point times worldToNDC is the place in the picture, (0,0) the upper left corner.
TEST(Render, WorldToNdcFindsTheTargetInTheMiddle) {
  TestFolder folder;
  ASSERT_EQ(candela({"render", scene("animated"), "-o", folder / "a.exr", "--size", "32x18", "--eye", "3,4,5",
                     "--target", "0.5,0.25,-1"})
                .code,
            0);
  const auto image = read_image(folder / "a.exr");
  ASSERT_TRUE(image);
  const auto apply = [&](const char* name, std::array<double, 3> p) {
    std::array<double, 4> out{};
    for (const MetadataEntry& entry : image->metadata)
      if (entry.name == name)
        for (size_t c = 0; c < 4; ++c)
          out[c] =
              p[0] * entry.matrix[c] + p[1] * entry.matrix[4 + c] + p[2] * entry.matrix[8 + c] + entry.matrix[12 + c];
    return out;
  };
  const auto middle = apply("worldToNDC", {0.5, 0.25, -1});
  EXPECT_NEAR(middle[0] / middle[3], 0.5, 1e-5);
  EXPECT_NEAR(middle[1] / middle[3], 0.5, 1e-5);
  const auto above = apply("worldToNDC", {0.5, 0.5, -1});
  EXPECT_LT(above[1] / above[3], 0.5);
  const auto camera = apply("worldToCamera", {0.5, 0.25, -1});
  EXPECT_NEAR(camera[2], -std::sqrt(2.5 * 2.5 + 3.75 * 3.75 + 36), 1e-4);
}

TEST(Sequence, AFrameIsTheSameBytesHoweverItIsReached) {
  TestFolder folder;
  ASSERT_EQ(candela(sequence(folder / "whole/%04d.exr", {"-o", folder / "whole/####.png"})).code, 0);
  ASSERT_EQ(files_in(folder / "whole").size(), 20u);
  const std::string exr = bytes_of(folder / "whole/0007.exr"), png = bytes_of(folder / "whole/0007.png");
  EXPECT_NE(exr, bytes_of(folder / "whole/0006.exr"));
  ASSERT_EQ(candela({"render", scene("animated"), "--frame", "7", "--size", "64x36", "-o", folder / "alone.exr", "-o",
                     folder / "alone.png"})
                .code,
            0);
  EXPECT_TRUE(exr == bytes_of(folder / "alone.exr"));
  EXPECT_TRUE(png == bytes_of(folder / "alone.png"));
  // All shards together are the whole, and no frame is made twice.
  std::set<std::string> seen;
  for (const char* shard : {"1/3", "2/3", "3/3"}) {
    const std::string part = std::string(shard).substr(0, 1);
    ASSERT_EQ(candela(sequence(folder / part + "/%04d.exr", {"-o", folder / part + "/%04d.png", "--shard", shard,
                                                             "--encoders", part == "1" ? "1" : "8"}))
                  .code,
              0);
    for (const auto& [name, bytes] : contents(folder / part)) {
      EXPECT_TRUE(seen.insert(name).second) << name;
      EXPECT_TRUE(bytes == bytes_of(folder / ("whole/" + name))) << name;
    }
  }
  EXPECT_EQ(seen.size(), 20u);
}

TEST(Sequence, KilledAtAnyTimeLeavesWholeFilesAndResumesToTheSameBytes) {
  TestFolder folder;
  ASSERT_EQ(candela(sequence(folder / "whole/%04d.exr", {"-o", folder / "whole/%04d.png"})).code, 0);
  const auto whole = contents(folder / "whole");
  const Arguments again = sequence(folder / "killed/%04d.exr", {"-o", folder / "killed/%04d.png", "--resume"});
  for (int round = 0; round < 8; ++round) {
    candela_killed_after(again, 60 + 70 * round, SIGKILL);
    if (!fs::exists(folder / "killed")) continue;
    for (const auto& [name, bytes] : contents(folder / "killed"))
      if (name[0] != '.')
        EXPECT_TRUE(whole.contains(name) && bytes == whole.at(name)) << name;  // hidden: temporary names
  }
  const Ended ended = candela(again);
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(contents(folder / "killed") == whole);
}

TEST(Sequence, ResumeMakesAgainWhatIsDamagedOrOfAnotherJob) {
  TestFolder folder;
  const auto rendered = [&](const Arguments& more) {
    Arguments arguments = sequence(folder / "%04d.exr", {"-o", folder / "%04d.png", "--resume", "--json"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Ended ended = candela(arguments);
    EXPECT_EQ(ended.code, 0) << ended.err;
    return Json::parse(ended.out)["rendered"].get<int>();
  };
  EXPECT_EQ(rendered({}), 10);
  EXPECT_EQ(rendered({}), 0);
  const auto whole = contents(folder.path());
  fs::resize_file(folder / "0003.exr", fs::file_size(folder / "0003.exr") - 10);
  fs::resize_file(folder / "0004.png", fs::file_size(folder / "0004.png") / 2);
  fs::remove(folder / "0005.png");
  std::ofstream(folder / "0006.exr") << "";
  EXPECT_EQ(rendered({}), 4);
  EXPECT_TRUE(contents(folder.path()) == whole);
  EXPECT_EQ(rendered({"--exposure", "1"}), 10);
  EXPECT_EQ(rendered({"--exposure", "1"}), 0);
  EXPECT_EQ(rendered({"--exposure", "1", "--fps", "25"}), 10);
}

TEST(Sequence, AnInterruptEndsCleanly) {
  TestFolder folder;
  for (const int milliseconds : {150, 400, 700}) {
    Arguments arguments = sequence(folder / "%04d.png", {"--frames", "0-9999"});
    arguments.erase(arguments.begin() + 2, arguments.begin() + 4);
    EXPECT_TRUE(candela_killed_after(arguments, milliseconds, SIGINT));
    for (const std::string& name : files_in(folder.path())) EXPECT_NE(name[0], '.') << name;
  }
}

TEST(Sequence, WritesAVideo) {
  if (run_program({"ffprobe", "-version"}).code != 0) GTEST_SKIP() << "ffprobe is not installed";
  TestFolder folder;
  const Ended ended = candela({"sequence", scene("animated"), "--frames", "0-9", "--size", "63x35", "--fps", "23.976",
                               "--video", folder / "a.mp4", "--video-pad"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const Ended probe = run_program({"ffprobe", "-v", "error", "-count_frames", "-select_streams", "v:0", "-show_entries",
                                   "stream=nb_read_frames,width,height,r_frame_rate", "-of", "json", folder / "a.mp4"});
  const Json stream = Json::parse(probe.out)["streams"][0];
  EXPECT_EQ(stream["nb_read_frames"], "10");
  EXPECT_EQ(stream["width"], 64);
  EXPECT_EQ(stream["r_frame_rate"], "24000/1001");
  EXPECT_EQ(files_in(folder.path()), (Arguments{"a.mp4"}));
  // A sound that ffmpeg cannot read ends the run; frames that were made until then stay.
  std::ofstream(folder / "noise.wav") << "no sound";
  const Ended broken = candela({"sequence", scene("animated"), "--frames", "0-9", "--size", "64x36", "--video",
                                folder / "b.mp4", "--audio", folder / "noise.wav"});
  EXPECT_EQ(broken.code, 5) << broken.err;
  for (const std::string& name : files_in(folder.path()))
    EXPECT_TRUE(name == "a.mp4" || name == "noise.wav" || name == "b.mp4.frames") << name;
}

TEST(Output, AFolderThatCannotBeWrittenIsExitFiveBeforeRendering) {
  TestFolder folder;
  std::ofstream(folder / "file") << "x";
  for (const std::string& out :
       {folder / "file/a.exr", std::string("/proc/candela/a.exr"), folder.path().string() + "/file/sub/a.png"}) {
    const Ended ended = candela({"render", scene("unlit-box"), "-o", out, "--size", "16x16"});
    EXPECT_EQ(ended.code, 5) << out << "\n" << ended.err;
    EXPECT_EQ(ended.err.find("device"), std::string::npos) << ended.err;
  }
  fs::create_directory(folder / "taken.exr");
  EXPECT_EQ(candela({"render", scene("unlit-box"), "-o", folder / "taken.exr"}).code, 5);
}

TEST(Output, AFullDiskIsExitFiveAndLeavesNothingBroken) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can make a small file system";
  TestFolder folder;
  const std::string disk = folder / "disk";
  fs::create_directory(disk);
  if (mount("candela-test", disk.c_str(), "tmpfs", 0, "size=256k") != 0) GTEST_SKIP() << "tmpfs cannot be mounted here";
  const Ended one =
      candela({"render", scene("animated"), "-o", disk + "/big.exr", "--size", "256x144", "--exr-compression", "none"});
  const auto after_one = files_in(disk);
  // The frames before the one that is named, whole, and nothing else, however many encode and hold temporary files.
  std::vector<Ended> many;
  std::vector<std::vector<std::pair<std::string, bool>>> whole;
  for (const char* encoders : {"1", "4"}) {
    many.push_back(candela({"sequence", scene("animated"), "--frames", "0-99", "-o", disk + "/%04d.exr", "--size",
                            "64x36", "--exr-compression", "none", "--quiet", "--encoders", encoders}));
    whole.emplace_back();
    for (const std::string& name : files_in(disk)) {
      whole.back().emplace_back(name, bool(read_image(disk + "/" + name)));
      fs::remove(disk + "/" + name);
    }
  }
  umount(disk.c_str());
  EXPECT_EQ(one.code, 5) << one.err;
  EXPECT_TRUE(after_one.empty());
  for (size_t i = 0; i < many.size(); ++i) {
    EXPECT_EQ(many[i].code, 5) << many[i].err;
    EXPECT_FALSE(whole[i].empty());
    EXPECT_NE(many[i].err.find(fmt::format("frame {}:", whole[i].size())), std::string::npos) << many[i].err;
    for (size_t frame = 0; frame < whole[i].size(); ++frame)
      EXPECT_EQ(whole[i][frame], std::pair(fmt::format("{:04}.exr", frame), true));
  }
}

// A triangle that emits close to the largest float, exposed by ten stops: infinity in every pixel that it covers.
constexpr const char* too_bright =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":1},"indices":0,"material":0}]}],
"materials":[{"emissiveFactor":[1,1,1],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":3e38}}}],
"extensionsUsed":["KHR_materials_emissive_strength"],
"buffers":[{"byteLength":44,"uri":"data:application/octet-stream;base64,AAABAAIAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPwAAAAA="}],
"bufferViews":[{"buffer":0,"byteLength":6},{"buffer":0,"byteOffset":8,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5123,"count":3,"type":"SCALAR"},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]})";

TEST(NonFinite, IsExitSevenWithTheCountThePixelAndThePass) {
  TestFolder folder;
  std::ofstream(folder / "bright.gltf") << too_bright;
  for (const char* name : {"a.exr", "a.png"}) {
    const Ended ended =
        candela({"render", folder / "bright.gltf", "-o", folder / name, "--size", "32x18", "--exposure", "10"});
    EXPECT_EQ(ended.code, 7) << ended.err;
    for (const char* part : {"pixels are not finite", "layer beauty", "the first pass that made one is shade_forward"})
      EXPECT_NE(ended.err.find(part), std::string::npos) << ended.err;
  }
  const Ended many = candela({"sequence", folder / "bright.gltf", "--frames", "3-5", "-o", folder / "%d.exr", "--size",
                              "32x18", "--exposure", "10"});
  EXPECT_EQ(many.code, 7);
  EXPECT_NE(many.err.find("frame 3:"), std::string::npos) << many.err;
  EXPECT_EQ(files_in(folder.path()), (Arguments{"bright.gltf"}));
  EXPECT_EQ(candela({"render", folder / "bright.gltf", "-o", folder / "a.exr", "--size", "32x18", "--exposure", "10",
                     "--allow-nonfinite"})
                .code,
            0);
}

constexpr const char* textured =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":1,"TEXCOORD_0":2},"indices":0,"material":0}]}],
"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],
"images":[{"uri":"cut.png"}],
"buffers":[{"byteLength":44,"uri":"data:application/octet-stream;base64,AAABAAIAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPwAAAAA="}],
"bufferViews":[{"buffer":0,"byteLength":6},{"buffer":0,"byteOffset":8,"byteLength":36},{"buffer":0,"byteOffset":8,"byteLength":24}],
"accessors":[{"bufferView":0,"componentType":5123,"count":3,"type":"SCALAR"},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":2,"componentType":5126,"count":3,"type":"VEC2"}]})";

TEST(BrokenTexture, IsAWarningOnceAndExitThreeWhenStrict) {
  TestFolder folder;
  ASSERT_EQ(candela({"render", scene("animated"), "-o", folder / "cut.png", "--size", "64x36"}).code, 0);
  fs::resize_file(folder / "cut.png", fs::file_size(folder / "cut.png") / 2);
  std::ofstream(folder / "textured.gltf") << textured;
  const Arguments one = {"render", folder / "textured.gltf", "--size", "16x16", "-o", folder / "a.exr"};
  const Arguments many = {"sequence", folder / "textured.gltf", "--size", "16x16", "--frames", "0-2",
                          "-o",       folder / "b%d.exr"};
  for (Arguments arguments : {one, many}) {
    arguments.push_back("--strict");
    const Ended refused = candela(arguments);
    EXPECT_EQ(refused.code, 3) << refused.err;
    EXPECT_EQ(files_in(folder.path()), (Arguments{"cut.png", "textured.gltf"}));
  }
  for (Arguments arguments : {one, many}) {
    arguments.insert(arguments.end(), {"--json", "--quiet"});
    const Ended ended = candela(arguments);
    EXPECT_EQ(ended.code, 0) << ended.err;
    const size_t said = ended.err.find("a magenta and black checker is drawn instead");
    EXPECT_NE(said, std::string::npos) << ended.err;
    EXPECT_EQ(ended.err.find("a magenta and black checker", said + 1), std::string::npos) << ended.err;
    const Json warnings = Json::parse(ended.out)["warnings"];
    ASSERT_EQ(warnings.size(), 1u) << warnings;
    EXPECT_NE(warnings[0].get<std::string>().find("/images/0"), std::string::npos) << warnings;
  }
}

TEST(Json, HoldsGpuTimesOnlyWhenTheyWereMeasured) {
  TestFolder folder;
  for (const bool timed : {false, true})
    for (Arguments arguments : {Arguments{"render", "-o", folder / "a.exr"},
                                Arguments{"sequence", "--frames", "0-1", "-o", folder / "%d.exr"}}) {
      arguments.insert(arguments.end(), {scene("unlit-box"), "--size", "16x16", "--json"});
      if (timed) arguments.insert(arguments.end(), {"--timings", folder / "t.json"});
      const Ended ended = candela(arguments);
      ASSERT_EQ(ended.code, 0) << ended.err;
      const Json timings = Json::parse(ended.out)["timings"];
      EXPECT_EQ(timings.contains("gpu_ms"), timed);
      EXPECT_EQ(timings.contains("gpu_frame_ms"), timed);
    }
}

TEST(Blank, IsAWarningThatSaysWhy) {
  TestFolder folder;
  const Ended ended = candela({"render", scene("unlit-box"), "-o", folder / "a.exr", "--size", "16x16", "--eye",
                               "0,0,100", "--target", "0,0,200", "--json"});
  EXPECT_EQ(ended.code, 0);
  EXPECT_NE(ended.err.find("blank"), std::string::npos) << ended.err;
  EXPECT_EQ(Json::parse(ended.out)["warnings"].size(), 1u);
}

TEST(Compare, ExitCodesAndLimits) {
  TestFolder folder;
  for (const auto& [name, exposure] : {std::pair("a.png", "0"), std::pair("b.png", "0.5")})
    ASSERT_EQ(
        candela({"render", scene("animated"), "-o", folder / name, "--size", "64x36", "--exposure", exposure}).code, 0);
  ASSERT_EQ(candela({"render", scene("animated"), "-o", folder / "small.png", "--size", "32x18"}).code, 0);
  EXPECT_EQ(
      candela({"compare", folder / "a.png", folder / "a.png", "--limit", "differing=0", "--limit", "flip=0"}).code, 0);
  EXPECT_EQ(candela({"compare", folder / "a.png", folder / "b.png"}).code, 0);
  const Ended over = candela({"compare", folder / "a.png", folder / "b.png", "--limit", "flip=0.0001", "--json",
                              "--heatmap", folder / "h.png"});
  EXPECT_EQ(over.code, 1);
  EXPECT_EQ(Json::parse(over.out)["pass"], false);
  EXPECT_GT(Json::parse(over.out)["metrics"]["flip"], 0);
  EXPECT_TRUE(read_image(folder / "h.png"));
  EXPECT_EQ(candela({"compare", folder / "a.png", folder / "small.png"}).code, 1);
}

}  // namespace
}  // namespace candela::test::cli_files
