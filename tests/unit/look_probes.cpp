// Reflection probes of look files.
#include <gtest/gtest.h>

#include "look/look.h"

namespace candela::test::scene_look_probes {
namespace {

constexpr const char* room = R"("box": {"min": [-1, 0, -2], "max": [1, 3, 2]})";

std::string look_with(const std::string& probe) { return R"({"probes": [)" + probe + "]}"; }
std::string error_of(const std::string& text) {
  const auto look = look_from_json(text, "l.json");
  EXPECT_FALSE(look) << text;
  if (look) return {};
  EXPECT_EQ(look.error().kind, ErrorKind::input);
  return look.error().text();
}

}  // namespace

TEST(LookProbes, AreReadAndSortedByTheirBoxes) {
  const auto look =
      look_from_json(fmt::format(R"({{"probes": [{{"position": [0, 1.5, 0.5], {}, "fade_m": 0.25, "time_s": -2}},
                                  {{"box": {{"max": [1, 1, 1], "min": [0, 0, 0]}}, "position": [0.5, 0.5, 0.25]}}]}})",
                                 room),
                     "l.json");
  ASSERT_TRUE(look) << look.error().text();
  ASSERT_EQ(look->probes.size(), 2u);
  const ReflectionProbe &small = look->probes[0], &large = look->probes[1];
  EXPECT_EQ(small.position, glm::dvec3(0.5, 0.5, 0.25));
  EXPECT_EQ(small.fade_m, 0.1) << "by default";
  EXPECT_EQ(small.time_s, 0);
  EXPECT_EQ(large.position, glm::dvec3(0, 1.5, 0.5));
  EXPECT_EQ(large.lowest, glm::dvec3(-1, 0, -2));
  EXPECT_EQ(large.highest, glm::dvec3(1, 3, 2));
  EXPECT_EQ(large.fade_m, 0.25);
  EXPECT_EQ(large.time_s, -2);
  EXPECT_EQ(switched_on(*look), std::vector<std::string>{"reflection probes"});
  const auto empty = look_from_json(R"({"probes": []})", "l.json");
  ASSERT_TRUE(empty);
  EXPECT_TRUE(empty->probes.empty());
}

TEST(LookProbes, NameWhatIsWrong) {
  const auto says = [](const std::string& text, const std::string& place, const std::string& what) {
    const std::string error = error_of(text);
    EXPECT_NE(error.find("l.json: " + place), std::string::npos) << error;
    EXPECT_NE(error.find(what), std::string::npos) << error;
  };
  const auto probe = [](const std::string& keys) { return look_with("{" + keys + "}"); };
  const std::string box = room, at = R"("position": [0, 1, 0], )";
  says(probe(box), "/probes/0", "lacks position");
  says(probe(R"("position": [0, 1, 0])"), "/probes/0", "lacks box");
  says(probe(at + R"("box": {"min": [0, 0, 0]})"), "/probes/0/box", "lacks max");
  says(probe(at + R"("box": {"max": [0, 0, 0]})"), "/probes/0/box", "lacks min");
  says(probe(at + R"("box": {"min": [-1, 2, -1], "max": [1, 2, 1]})"), "/probes/0/box", "y of min, 2, is not below");
  says(probe(R"("position": [0, 3, 0], )" + box), "/probes/0/position", "y 3 is not inside the box");
  says(probe(R"("position": [0, 1, 2.1], )" + box), "/probes/0/position", "z 2.1 is not inside the box");
  says(probe(R"("position": [0, 1], )" + box), "/probes/0/position", "three numbers");
  says(probe(R"("position": [0, 1, 1e39], )" + box), "/probes/0/position/2", "32-bit");
  says(probe(R"("position": [0, "1", 0], )" + box), "/probes/0/position/1", "not a number");
  says(probe(at + box + R"(, "fade_m": 0)"), "/probes/0/fade_m", "not above 0");
  says(probe(at + box + R"(, "fade_m": -1)"), "/probes/0/fade_m", "-1 is below 0");
  says(probe(at + box + R"(, "fade": 1)"), "/probes/0/fade", "unknown key");
  says(probe(at + box + R"(, "time_s": {"keys": [[0, 1]]})"), "/probes/0/time_s", "the same at all times");
  says(probe(R"("position": {"keys": [[0, [0, 1, 0]]]}, )" + box), "/probes/0/position", "the same at all times");
  says(R"({"probes": {}})", "/probes", "not a list");
  says(R"({"probes": [1]})", "/probes/0", "not an object");
  std::string many = "{" + at + box + "}";
  for (int i = 0; i < 8; ++i) many += ", {" + at + box + "}";
  says(look_with(many), "/probes", "holds 9 values; 8 at most");
}

}  // namespace candela::test::scene_look_probes
