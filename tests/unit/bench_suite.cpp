#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "bench/exactness.h"
#include "bench/row.h"
#include "bench/suite.h"
#include "job/frame_knobs.h"
#include "plan/plan_frame.h"

namespace candela {
namespace {

Expected<Suite> suite_of(const std::string& json) { return suite_from_json(json, "s.json", "folder", "no/assets"); }

std::string error_of(const std::string& json) {
  const auto suite = suite_of(json);
  return suite ? "" : suite.error().text();
}

TEST(Suite, ConfigurationsAreTheCrossProduct) {
  const auto suite = suite_of(R"({"scenes": ["animated", "rooms/hall.glb"], "lights": [4, 16],
      "techniques": ["brute-force"], "sizes": ["32x18", "64x36"], "samples": [1, 4], "times": [0, 0.5],
      "set": {"cull.enabled": [0, 1]}})");
  ASSERT_TRUE(suite) << suite.error().text();
  const auto all = configurations(*suite);
  ASSERT_TRUE(all) << all.error().text();
  // The file has its own lights: one configuration where the generated scene has two.
  EXPECT_EQ(all->size(), (2u + 1u) * 2 * 2 * 2 * 2);
  std::set<std::string> different;
  for (const Configuration& c : *all)
    different.insert(job_json(c.job) + std::to_string(c.lights.value_or(-1)) + std::to_string(c.time_s));
  EXPECT_EQ(different.size(), all->size());
  EXPECT_EQ(all->front().scene.label, "animated");
  EXPECT_EQ(all->back().scene.file, "folder/rooms/hall.glb");
  EXPECT_FALSE(all->back().lights.has_value());
}

TEST(Suite, MethodsOfTransparencyAreAnAxis) {
  const auto suite = suite_of(R"({"scenes": ["smoke"], "techniques": ["clustered", "brute-force"],
      "transparency": ["sorted", "moments", "layers"]})");
  ASSERT_TRUE(suite) << suite.error().text();
  const auto all = configurations(*suite);
  ASSERT_TRUE(all) << all.error().text();
  std::set<std::pair<std::string, std::string>> seen;
  for (const Configuration& c : *all) seen.insert({c.job.technique, c.job.transparency});
  EXPECT_EQ(all->size(), 6u);
  EXPECT_EQ(seen.size(), 6u);
}

// Every file of bench/suites is one that the program takes.
TEST(Suite, TheProjectsOwnAreTaken) {
  size_t taken = 0;
  for (const auto& entry : std::filesystem::directory_iterator(CANDELA_SOURCE_DIR "/bench/suites")) {
    if (entry.path().extension() != ".json" || entry.path().string().ends_with(".look.json")) continue;
    std::ifstream file(entry.path());
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (text.find("\"suite\": \"stability\"") != std::string::npos) continue;  // of another kind (stability_suite.cpp)
    const auto suite = suite_from_json(text, entry.path().string(), entry.path().parent_path(), "no/assets");
    EXPECT_TRUE(suite) << (suite ? "" : suite.error().text());
    ++taken;
  }
  EXPECT_GE(taken, 8u);
}

TEST(Suite, WhatLimitsLeaveOutSaysWhy) {
  const auto suite = suite_of(R"({"scenes": ["animated"], "lights": [4, 5000], "max_lights": {"brute-force": 4096}})");
  ASSERT_TRUE(suite) << suite.error().text();
  const auto all = configurations(*suite);
  ASSERT_TRUE(all) << all.error().text();
  for (const Configuration& c : *all) {
    if (c.job.technique != "brute-force") continue;
    EXPECT_EQ(c.left_out.empty(), *c.lights == 4);
    EXPECT_EQ(c.left_out.find("4096") != std::string::npos, *c.lights == 5000);
  }
}

TEST(Suite, ASceneMayHaveItsOwnLightsSeedAndCamera) {
  const auto suite = suite_of(R"({"scenes": [{"scene": "animated", "lights": 7, "seed": 3, "eye": [1, 2, 3],
      "target": [0, 0, 0], "yfov": 40}], "lights": [4, 16], "techniques": ["brute-force"]})");
  ASSERT_TRUE(suite) << suite.error().text();
  const auto all = configurations(*suite);
  ASSERT_TRUE(all) << all.error().text();
  ASSERT_EQ(all->size(), 1u);
  EXPECT_EQ(all->front().lights, 7);
  EXPECT_EQ(all->front().seed, 3u);
  ASSERT_TRUE(all->front().job.camera.eye);
  EXPECT_EQ(all->front().job.camera.eye->y, 2);
}

// Skies and looks are a scene's, effects an axis; rows tell them apart by their names as written.
TEST(Suite, AScenesSkyAndLookAndTheEffectsReachTheJobs) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "suite_looks";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "dusk.json") << "{}";
  const std::string text = R"({"scenes": [{"scene": "spheres", "look": "dusk.json"}, "spheres"], "effects":
      ["none", "auto"], "techniques": ["brute-force"]})";
  const auto suite = suite_from_json(text, "s.json", folder, "no/assets");
  ASSERT_TRUE(suite) << suite.error().text();
  const auto all = configurations(*suite);
  ASSERT_TRUE(all) << all.error().text();
  ASSERT_EQ(all->size(), 4u);
  EXPECT_EQ((*all)[0].job.effects, "none");
  EXPECT_EQ((*all)[1].job.effects, "auto");
  EXPECT_EQ((*all)[0].job.look, (folder / "dusk.json").string());
  EXPECT_EQ((*all)[0].scene.look.label, "dusk.json");
  EXPECT_TRUE((*all)[2].job.look.empty());
  BenchRow a, b;
  b.look = "dusk.json";
  EXPECT_NE(row_key(a), row_key(b));
  b = a, b.effects = "none";
  EXPECT_NE(row_key(a), row_key(b));
  EXPECT_NE(row_title(b).find("effects none"), std::string::npos);
  // What lies elsewhere is an error that names the key.
  std::ofstream(folder.parent_path() / "suite_elsewhere.json") << "{}";
  const auto elsewhere = suite_from_json(R"({"scenes": [{"scene": "spheres", "look": "../suite_elsewhere.json"}]})",
                                         "s.json", folder, "no/assets");
  ASSERT_FALSE(elsewhere);
  EXPECT_NE(elsewhere.error().text().find("/scenes/0/look"), std::string::npos) << elsewhere.error().text();
  const auto misspelt = suite_of(R"({"scenes": ["spheres"], "effects": ["blom"]})");
  ASSERT_TRUE(misspelt);
  EXPECT_NE(configurations(*misspelt).error().text().find("bloom"), std::string::npos);
  // Assets that are not there leave the scene out, with the reason.
  const auto without = suite_of(R"({"scenes": [{"scene": "spheres", "sky": "assets:env/dusk.hdr"}]})");
  ASSERT_TRUE(without) << without.error().text();
  EXPECT_FALSE(configurations(*without)->front().left_out.empty());
}

TEST(Suite, ATechniquesOwnKnobsReplaceTheSuites) {
  const auto suite = suite_of(R"({"scenes": ["spheres"], "set": {"cull.enabled": [0, 1]}, "techniques":
      ["brute-force", {"technique": "brute-force", "set": {"cull.enabled": 1}}]})");
  ASSERT_TRUE(suite) << suite.error().text();
  EXPECT_EQ(configurations(*suite)->size(), 2u + 1u);
}

TEST(Suite, FramesBecomeTimesByTheRate) {
  const auto suite = suite_of(R"({"scenes": ["spheres"], "frames": "0-4x2", "fps": 20})");
  ASSERT_TRUE(suite) << suite.error().text();
  EXPECT_EQ(suite->times_s, (std::vector{0.0, 0.1, 0.2}));
  EXPECT_NE(error_of(R"({"scenes": ["spheres"], "frames": "0", "times": [0]})").find("/frames"), std::string::npos);
}

TEST(Suite, IsStrict) {
  EXPECT_NE(error_of(R"({"scenes": ["spheres"], "technqiues": []})").find("did you mean 'techniques'"),
            std::string::npos);
  EXPECT_NE(error_of(R"({"scenes": [{"scene": "spheres", "sede": 1}]})").find("s.json: /scenes/0/sede"),
            std::string::npos);
  EXPECT_NE(error_of(R"({"scenes": ["spheres"], "lights": [1, -4]})").find("/lights/1"), std::string::npos);
  EXPECT_NE(error_of(R"({"scenes": ["spheres"], "lights": [1.5]})").find("/lights/0"), std::string::npos);
  EXPECT_NE(error_of(R"({"scenes": ["spheres"], "lights": [4294967297]})").find("/lights/0"), std::string::npos);
  EXPECT_NE(error_of(R"({"scenes": ["spheres"], "seed": -1})").find("/seed"), std::string::npos);
  EXPECT_NE(error_of(R"({"scenes": ["spheres"], "sizes": ["12"]})").find("/sizes/0"), std::string::npos);
  EXPECT_NE(error_of(R"({"scenes": ["spheres"], "set": {"cull": [1]}})").find("PASS.KNOB"), std::string::npos);
  EXPECT_NE(error_of(R"({"scenes": ["spheres"], "budget_s": 0})").find("/budget_s"), std::string::npos);
  EXPECT_NE(error_of(R"({"scenes": []})").find("/scenes"), std::string::npos);
  EXPECT_NE(error_of(R"({"lights": [1]})").find("/scenes"), std::string::npos);
  EXPECT_NE(error_of("[1]"), "");
  EXPECT_NE(error_of("{"), "");
}

TEST(Suite, NamesThatNoJobTakesAreErrors) {
  for (const char* json :
       {R"({"scenes": ["spheres"], "techniques": ["brut-force"]})",
        R"({"scenes": ["spheres"], "reference": "brut-force"})",
        R"({"scenes": ["spheres"], "max_lights": {"brut-force": 3}})",
        R"({"scenes": ["spheres"], "set": {"cull.enabld": [1]}})", R"({"scenes": ["spheres"], "output": "jpg"})",
        R"({"scenes": ["spheres"], "samples": [3]})", R"({"scenes": [{"scene": "a.glb", "lights": 3}]})"}) {
    const auto suite = suite_of(json);
    ASSERT_TRUE(suite) << json;
    const auto all = configurations(*suite);
    ASSERT_FALSE(all) << json;
    EXPECT_EQ(all.error().kind, ErrorKind::usage) << json;
  }
}

TEST(Suite, MistakesInAFileNameIt) {
  const auto file = std::filesystem::path(testing::TempDir()) / "mistaken.json";
  for (const auto& [json, said] :
       {std::pair(R"({"scenes": ["spheres"], "techniques": ["brut-force"]})", "mistaken.json: techniques: "),
        std::pair(R"({"scenes": ["spheres"], "set": {"cull.enabld": [1]}})", "mistaken.json: set: "),
        std::pair(R"({"scenes": ["spheres"], "sizes": ["0x0"]})", "mistaken.json: size: ")}) {
    std::ofstream(file) << json;
    const auto suite = read_suite(file, {});
    ASSERT_FALSE(suite) << json;
    EXPECT_NE(suite.error().text().find(said), std::string::npos) << suite.error().text();
  }
}

TEST(Suite, ScenesOfMissingAssetsAreLeftOut) {
  const auto suite = suite_of(R"({"scenes": ["assets:a/b.glb"], "techniques": ["brute-force"]})");
  ASSERT_TRUE(suite);
  const auto all = configurations(*suite);
  ASSERT_TRUE(all);
  EXPECT_NE(all->front().left_out.find("no/assets"), std::string::npos);
}

TEST(Suite, OnePictureIsOneGroupWhateverTheKnobsOfTime) {
  const auto suite = suite_of(R"({"scenes": ["animated"], "lights": [4, 16], "techniques": ["brute-force"],
      "set": {"cull.enabled": [0, 1]}})");
  ASSERT_TRUE(suite);
  const auto all = configurations(*suite);
  ASSERT_TRUE(all);
  ASSERT_EQ(all->size(), 4u);
  EXPECT_EQ(picture_group((*all)[0], *suite), picture_group((*all)[1], *suite));
  EXPECT_NE(picture_group((*all)[0], *suite), picture_group((*all)[2], *suite));
  EXPECT_TRUE(reference_of((*all)[0], "brute-force").job.settings.empty());
}

// What trades error or is of the look changes the picture: every value is a group of its own, with a reference that has
// the value too.
TEST(Suite, EveryValueOfAKnobThatChangesThePictureIsAGroup) {
  const std::vector<KnobRow> rows = knob_rows("high");
  std::set<std::string> kinds;
  for (const KnobRow& row : rows) {
    kinds.insert(row.kind);
    Configuration one;
    one.job.technique = "clustered";
    one.job.settings = {{row.pass, row.knob, row.value_now}, {"cull", "enabled", "0"}};
    Configuration other = one;
    other.job.settings[0].value += "0";
    const bool is_of_time = row.kind == "time";
    const std::string name = row.pass + "." + row.knob;
    EXPECT_EQ(picture_group(one, {}) == picture_group(other, {}), is_of_time) << name;
    EXPECT_EQ(settings_text(reference_of(one, "brute-force").job), is_of_time ? "" : name + "=" + row.value_now);
  }
  EXPECT_EQ(kinds, (std::set<std::string>{"error", "look", "time"}));
}

TEST(Sweep, IsAKnobWithValues) {
  const auto sweep = parse_knob_sweep("lights.test=aabb,capsule");
  ASSERT_TRUE(sweep);
  EXPECT_EQ(sweep->pass, "lights");
  EXPECT_EQ(sweep->knob, "test");
  EXPECT_EQ(sweep->values, (std::vector<std::string>{"aabb", "capsule"}));
  EXPECT_FALSE(parse_knob_sweep("lights.test=aabb,,capsule"));
  EXPECT_FALSE(parse_knob_sweep("lights=1"));
}

TEST(Exactness, FieldsAndKnobsAreDrawnFromTheirSeed) {
  std::set<int> counts;
  std::set<std::string> drawn;
  for (uint64_t seed = 1; seed <= 200; ++seed) {
    counts.insert(lights_of_field(seed));
    Job job;
    job.settings = drawn_settings(seed);
    for (const KnobSetting& s : job.settings) drawn.insert(s.pass + "." + s.knob + "=" + s.value);
    EXPECT_TRUE(frame_knobs(job)) << settings_text(job);
  }
  std::set<std::string> all;
  for (const DrawnKnob& knob : drawn_knobs())
    for (const std::string& value : knob.values) all.insert(knob.pass + "." + knob.knob + "=" + value);
  EXPECT_EQ(drawn, all);
  EXPECT_GE(*counts.begin(), 1);
  EXPECT_LE(*counts.rbegin(), 512);
  EXPECT_GT(counts.size(), 50u);
  EXPECT_EQ(lights_of_field(7), lights_of_field(7));
}

TEST(Exactness, EveryKnobIsDrawnOrKnownToChangeThePicture) {
  const std::vector<std::string> changing = picture_changing_knobs();
  std::set<std::string> known(changing.begin(), changing.end()), all;
  for (const DrawnKnob& knob : drawn_knobs()) EXPECT_TRUE(known.insert(knob.pass + "." + knob.knob).second);
  for (const KnobRow& knob : knob_rows("high")) all.insert(knob.pass + "." + knob.knob);
  EXPECT_EQ(known, all) << "a new knob of time belongs into drawn_knobs()";
}

}  // namespace
}  // namespace candela
