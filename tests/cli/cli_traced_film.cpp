#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "image/io.h"
#include "program.h"

namespace candela::test::cli_traced_film {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

Arguments film(const std::string& pattern, const Arguments& more = {}) {
  Arguments words = {"sequence", scene("animated"), "--technique", "reference", "--size", "24x14", "--frames", "0-5",
                     "--quiet",  "--spp",           "2",           "--seed",    "5",      "-o",    pattern};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const std::string& name : files_in(folder)) files[name] = bytes_of(folder / name);
  return files;
}

void expect_same_pixels(const std::string& one, const std::string& other) {
  const auto a = read_image(one), b = read_image(other);
  ASSERT_TRUE(a && b);
  ASSERT_EQ(a->channels.size(), b->channels.size());
  for (const Channel& channel : a->channels) {
    const Channel* same = b->find(channel.name);
    ASSERT_TRUE(same) << channel.name;
    EXPECT_TRUE(channel.f == same->f && channel.u == same->u) << channel.name;
  }
}

}  // namespace

TEST(TracedFilm, AFrameHasThePixelsOfTheReference) {
  const TestFolder folder;
  for (const std::string mode : {"direct", "path"}) {
    const Arguments more = {"--mode", mode, "--layers", "variance,depth,object_id"};
    Arguments words = film(folder / (mode + "/%04d.exr"), more);
    words.insert(words.end(), {"-o", folder / (mode + "/%04d.png"), "--json"});
    const Ended made = candela(words);
    ASSERT_EQ(made.code, 0) << made.err;
    const Json json = Json::parse(made.out);
    EXPECT_EQ(json["rendered"], 6);
    EXPECT_EQ(json["reference"]["mode"], mode);
    EXPECT_EQ(json["job"]["technique"], "reference");
    words = {"reference", scene("animated"), "--size", "24x14", "--frame",        "4",  "--quiet",       "--spp",
             "2",         "--seed",          "5",      "-o",    folder / "a.exr", "-o", folder / "a.png"};
    words.insert(words.end(), more.begin(), more.end());
    ASSERT_EQ(candela(words).code, 0);
    expect_same_pixels(folder / (mode + "/0004.exr"), folder / "a.exr");
    expect_same_pixels(folder / (mode + "/0004.png"), folder / "a.png");
    EXPECT_NE(bytes_of(folder / (mode + "/0004.exr")), bytes_of(folder / (mode + "/0003.exr")));
  }
}

TEST(TracedFilm, ShardsAndResumptionGiveTheSameBytes) {
  const TestFolder folder;
  ASSERT_EQ(candela(film(folder / "whole/%04d.exr", {"-o", folder / "whole/%04d.png"})).code, 0);
  const auto whole = contents(folder / "whole");
  ASSERT_EQ(whole.size(), 12u);
  const auto part = [&](const Arguments& more) {
    Arguments words = film(folder / "part/%04d.exr", {"-o", folder / "part/%04d.png", "--json"});
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = candela(words);
    EXPECT_EQ(ended.code, 0) << ended.err;
    return Json::parse(ended.out);
  };
  EXPECT_EQ(part({"--shard", "1/2", "--threads", "1", "--encoders", "1"})["rendered"], 3);
  EXPECT_EQ(contents(folder / "part").size(), 6u);
  EXPECT_EQ(part({"--shard", "2/2"})["rendered"], 3);
  EXPECT_EQ(contents(folder / "part"), whole);
  // What is whole and holds this picture stays; what is cut or gone is made again.
  fs::resize_file(folder / "part/0001.exr", 200);
  fs::remove(folder / "part/0004.png");
  const Json resumed = part({"--resume"});
  EXPECT_EQ(resumed["rendered"], 2);
  EXPECT_EQ(resumed["skipped"], 4);
  EXPECT_EQ(contents(folder / "part"), whole);
  // All that decides a pixel is part of what a file says it holds.
  for (const Arguments& other : {Arguments{"--spp", "3"}, {"--mode", "path"}, {"--seed", "6"}, {"--ambient", "off"}}) {
    Arguments words = {"--resume", "--frames", "0-1"};
    words.insert(words.end(), other.begin(), other.end());
    Arguments all = {"sequence", scene("animated"), "--technique", "reference", "--size",
                     "24x14",    "--quiet",         "--json",      "-o",        folder / "part/%04d.exr"};
    if (other[0] != "--spp") words.insert(words.end(), {"--spp", "2"});
    if (other[0] != "--seed") words.insert(words.end(), {"--seed", "5"});
    all.insert(all.end(), words.begin(), words.end());
    const Ended ended = candela(all);
    ASSERT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(Json::parse(ended.out)["rendered"], 2) << other[0];
  }
}

// Signals end it in the middle of a frame; no file is half of one, and what was there stays.
TEST(TracedFilm, EndedByASignalItGoesOnToTheSameBytes) {
  const TestFolder folder;
  const auto slow = [&](const std::string& name, const Arguments& more) {
    Arguments words = {"sequence",
                       scene("animated"),
                       "--technique",
                       "reference",
                       "--size",
                       "48x27",
                       "--frames",
                       "0-5",
                       "--quiet",
                       "--spp",
                       "64",
                       "-o",
                       folder / (name + "/%04d.exr")};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  ASSERT_EQ(candela(slow("whole", {})).code, 0);
  const auto whole = contents(folder / "whole");
  for (const int signal : {SIGINT, SIGKILL, SIGTERM}) {
    candela_killed_after(slow("ended", {"--resume"}), 300, signal);
    if (!fs::exists(folder / "ended")) continue;
    for (const auto& [name, bytes] : contents(folder / "ended"))
      if (name[0] != '.') {  // hidden: temporary names
        EXPECT_TRUE(whole.contains(name) && bytes == whole.at(name)) << name;
      }
  }
  // A frame of hours is given up, not waited for.
  ASSERT_TRUE(
      candela_killed_after({"sequence", scene("animated"), "--technique", "reference", "--size", "48x27", "--frames",
                            "0-1", "--quiet", "--spp", "100000000", "-o", folder / "endless.%d.exr"},
                           700, SIGINT));
  EXPECT_EQ(candela(slow("ended", {"--resume"})).code, 0);
  EXPECT_EQ(contents(folder / "ended"), whole);
}

TEST(TracedFilm, OptionsOfTheOtherMakerAreErrors) {
  const TestFolder folder;
  const std::string out = folder / "%d.exr";
  for (const Arguments& more : {Arguments{"--quality", "draft"},
                                {"--samples", "4"},
                                {"--set", "lights.floor_lux=1"},
                                {"--effects", "none"},
                                {"--device", "cpu"},
                                {"--devices", "all"},
                                {"--validate"},
                                {"--cache", "on"},
                                {"--in-flight", "2"},
                                {"--timings", "-"},
                                {"--metadata-timings"}}) {
    const Ended ended = candela(film(out, more));
    EXPECT_EQ(ended.code, 2) << more[0];
    EXPECT_NE(ended.err.find(more[0] + ":"), std::string::npos) << ended.err;
  }
  for (const Arguments& more :
       {Arguments{"--spp", "4"}, {"--mode", "path"}, {"--fog-steps", "2"}, {"--threads", "1"}}) {
    Arguments words = {"sequence", scene("animated"), "--frames", "0-1", "--size", "24x14", "-o", out};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = candela(words);
    EXPECT_EQ(ended.code, 2) << more[0];
    EXPECT_NE(ended.err.find("--technique reference"), std::string::npos) << ended.err;
  }
  for (const auto& [more, word] :
       std::vector<std::pair<Arguments, std::string>>{{{"--layers", "varianc"}, "variance"},
                                                      {{"--view", "heatmap_lights"}, "heatmap"},
                                                      {{"--bounces", "2"}, "--mode path"}}) {
    const Ended ended = candela(film(out, more));
    EXPECT_EQ(ended.code, 2) << ended.err;
    EXPECT_NE(ended.err.find(word), std::string::npos) << ended.err;
  }
  EXPECT_EQ(candela({"render", scene("animated"), "--technique", "reference", "-o", folder / "a.exr"}).code, 2);
  EXPECT_TRUE(files_in(folder.path()).empty());
}

// The environment's device is meant for the commands that have one.
TEST(TracedFilm, AFarmMakesAndChecksIt) {
  const TestFolder folder;
  Arguments words = film("out/%04d.exr", {"--job", "film.farm", "--shards", "2"});
  words.insert(words.begin(), "farm");
  words[1] = "shell";
  const Ended written = candela(words, folder.path());
  ASSERT_EQ(written.code, 0) << written.err;
  EXPECT_EQ(candela({"farm", "check", "film.farm"}, folder.path()).code, 1);
  const Ended ran = run_program({"env", "CANDELA_DEVICE=cpu", "sh", "film.farm/job.sh"}, folder.path());
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Ended status = candela({"farm", "status", "film.farm", "--whole", "--json"}, folder.path());
  ASSERT_EQ(status.code, 0) << status.err;
  EXPECT_EQ(Json::parse(status.out)["frames"]["done"], 6);
  ASSERT_EQ(candela(film(folder / "whole/%04d.exr")).code, 0);
  EXPECT_EQ(contents(folder / "out"), contents(folder / "whole"));
}

}  // namespace candela::test::cli_traced_film
