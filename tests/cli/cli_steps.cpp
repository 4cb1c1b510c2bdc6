// render --steps: each pass of the frame has its section, each picture its file, and nothing comes from outside.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "image/io.h"
#include "program.h"

namespace candela::test::cli_steps {
namespace {

// What stands between each `before` and the next `behind`.
std::vector<std::string> all_between(const std::string& text, const std::string& before, const std::string& behind) {
  std::vector<std::string> found;
  for (size_t at = text.find(before); at != std::string::npos; at = text.find(before, at)) {
    at += before.size();
    found.push_back(text.substr(at, text.find(behind, at) - at));
  }
  return found;
}

}  // namespace

TEST(Steps, EveryPassHasItsEntryAndEveryPictureItsFile) {
  for (const char* technique : {"clustered", "visibility", "deferred-tiled", "deferred-volumes", "ray"}) {
    SCOPED_TRACE(technique);
    const TestFolder folder;
    const std::string steps = folder / "steps";
    const Ended ended = candela({"render", scene("street"), "--size", "64x36", "--technique", technique, "--steps",
                                 steps, "--quiet", "--timings", folder / "times.json"});
    ASSERT_EQ(ended.code, 0) << ended.err;
    const std::string page = bytes_of(std::filesystem::path(steps) / "index.html");
    const auto times = nlohmann::json::parse(bytes_of(folder / "times.json"));
    size_t passes = 0;
    for (const auto& pass : times["gpu_ms"].items()) {
      ++passes;
      EXPECT_NE(page.find("</span> " + pass.key() + " <span"), std::string::npos) << pass.key();
    }
    EXPECT_GE(passes, 8u);
    EXPECT_EQ(all_between(page, "<section class=\"pass\" id=\"", "\"").size(), passes);
    // Links lead to sections that are there.
    const std::vector<std::string> sections = all_between(page, "<section class=\"pass\" id=\"", "\"");
    for (const std::string& link : all_between(page, "href=\"#", "\""))
      EXPECT_NE(std::ranges::find(sections, link), sections.end()) << link;
    std::set<std::string> files;
    for (const std::string& file : all_between(page, "<img src=\"", "\"")) {
      EXPECT_TRUE(files.insert(file).second) << file;
      EXPECT_TRUE(read_image(std::filesystem::path(steps) / file)) << file;
    }
    EXPECT_GE(files.size(), 6u);
    files.insert("index.html");
    const std::vector<std::string> there = files_in(steps);
    EXPECT_EQ(std::set<std::string>(there.begin(), there.end()), files);
    EXPECT_EQ(page.find("http"), std::string::npos);
    EXPECT_NE(page.find("prefers-color-scheme:dark"), std::string::npos);
  }
}

TEST(Steps, LeaveThePictureAsItIs) {
  const TestFolder folder;
  const auto render = [&](const std::string& file, std::vector<std::string> more) {
    std::vector<std::string> words = {"render", scene("spheres"), "--size", "48x32", "--quiet", "-o", folder / file};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = candela(words);
    EXPECT_EQ(ended.code, 0) << ended.err;
    return bytes_of(folder / file);
  };
  EXPECT_TRUE(render("a.exr", {}) == render("b.exr", {"--steps", folder / "steps"}));
}

TEST(Steps, SaysWhatIsWrong) {
  const TestFolder folder;
  const auto refused = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"render", scene("unlit-box"), "--size", "48x32", "--steps", folder / "steps"};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = candela(words);
    EXPECT_EQ(ended.code, 2) << ended.err;
    return ended.err;
  };
  EXPECT_NE(refused({"--region", "0,0,8,8"}).find("looks at whole images"), std::string::npos);
  EXPECT_NE(refused({"--frames", "0-1", "-o", folder / "####.png"}).find("of one picture"), std::string::npos);
  EXPECT_EQ(candela({"render", scene("unlit-box"), "--size", "48x32", "--steps", folder / "steps"}).code, 0);
  EXPECT_NE(refused({}).find("holds a page already"), std::string::npos);
}

}  // namespace candela::test::cli_steps
