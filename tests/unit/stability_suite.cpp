#include <gtest/gtest.h>

#include <set>

#include "plan/plan_frame.h"
#include "stability/stability.h"

namespace candela {
namespace {

std::string error_of(const std::string& json) {
  const auto read = stability_suite_from_json(json, "s.json");
  return read ? "" : read.error().text();
}

std::set<std::string> scenes(const std::vector<std::string>& families, const std::vector<std::pair<int, int>>& sizes) {
  std::set<std::string> names;
  for (const StabilityRecipe& recipe : stability_recipes(sizes))
    if (families.empty() || std::find(families.begin(), families.end(), recipe.family) != families.end())
      names.insert(recipe.family + "/" + recipe.name);
  return names;
}

TEST(StabilitySuite, TheFileOfThisProjectHoldsEveryScene) {
  const std::string file = CANDELA_SOURCE_DIR "/bench/suites/stability.json";
  EXPECT_TRUE(names_built_in_suite(file));
  const auto suite = read_stability_suite(file);
  ASSERT_TRUE(suite) << suite.error().text();
  EXPECT_EQ(scenes(suite->families, suite->sizes), scenes({}, {})) << "a new family belongs into " << file;
  EXPECT_TRUE(suite->techniques.empty() || suite->techniques.size() == technique_names().size());
  EXPECT_TRUE(suite->only.empty());
  EXPECT_EQ(suite->seed, StabilityOptions().seed);
  EXPECT_FALSE(names_built_in_suite(CANDELA_SOURCE_DIR "/bench/suites/lights.json"));
}

TEST(StabilitySuite, ChoosesFamiliesSizesTechniquesAndSeed) {
  const auto suite = stability_suite_from_json(
      R"({"suite": "stability", "families": ["tone", "images"], "only": "images", "sizes": ["5x7", "8192x8192"],
          "techniques": "clustered", "seed": 12345678901234567890, "large": true})",
      "s.json");
  ASSERT_TRUE(suite) << suite.error().text();
  EXPECT_EQ(suite->families, (std::vector<std::string>{"tone", "images"}));
  EXPECT_EQ(suite->only, std::vector<std::string>{"images"});
  EXPECT_EQ(suite->techniques, std::vector<std::string>{"clustered"});
  EXPECT_EQ(suite->seed, 12345678901234567890u);
  EXPECT_TRUE(suite->large);
  const auto names = scenes({"images"}, suite->sizes);
  EXPECT_EQ(names, (std::set<std::string>{"images/5x7", "images/8192x8192", "images/16385x1", "images/0x0"}));
}

TEST(StabilitySuite, RefusesWhatItDoesNotKnowByFileAndKey) {
  const std::string head = R"({"suite": "stability", )";
  for (const auto& [json, said] : std::vector<std::pair<std::string, std::string>>{
           {"[]", "s.json: is not a JSON object"},
           {"{", "s.json: invalid JSON at byte 2"},
           {R"({"suite": "exactness"})", "s.json: /suite"},
           {head + R"("familys": ["tone"]})", "did you mean 'families'"},
           {head + R"("families": ["tones"]})", "s.json: /families/0"},
           {head + R"("families": []})", "is an empty list"},
           {head + R"("techniques": ["brut-force"]})", "s.json: /techniques/0"},
           {head + R"("sizes": ["5 by 7"]})", "s.json: /sizes/0"},
           {head + R"("sizes": ["5x7", "5x7"]})", "twice"},
           {head + R"("seed": -1})", "s.json: /seed"},
           {head + R"("seed": 1.5})", "s.json: /seed"},
           {head + R"("large": 1})", "s.json: /large"},
           {head + R"("scenes": ["street"]})", "s.json: /scenes"}})
    EXPECT_NE(error_of(json).find(said), std::string::npos) << json << ": " << error_of(json);
}

}  // namespace
}  // namespace candela
