#include "base/json.h"

#include <gtest/gtest.h>

namespace candela {
namespace {

std::string refusal(std::string_view text) {
  const auto json = read_json(text, "a.json");
  return json ? "" : json.error().text();
}

TEST(Json, KeepsOrderAndNumbersAsTheyAreWritten) {
  const auto json = read_json(R"({"b": 1.0, "a": [1, -2, 1e3, true, null, "x"]})", "a.json");
  ASSERT_TRUE(json) << json.error().text();
  EXPECT_EQ(json->dump(), R"({"b":1.0,"a":[1,-2,1000.0,true,null,"x"]})");
  EXPECT_TRUE(parse_json<nlohmann::json>("1.0", JsonDialect::gltf)->is_number_integer());
}

TEST(Json, WhatIsRefusedIsNamedWithItsPlace) {
  EXPECT_EQ(refusal(R"({"a": [0, {"b/c": 1, "b/c": 2}]})"),
            "a.json: /a/1/b~1c: the key 'b/c' occurs twice in one object");
  EXPECT_EQ(refusal(R"({"a": 1e999})"), "a.json: /a: number 1e999 is out of range");
  EXPECT_NE(refusal("{").find("a.json: invalid JSON at byte 2"), std::string::npos) << refusal("{");
  EXPECT_NE(refusal("").find("invalid JSON"), std::string::npos);
  EXPECT_NE(refusal("\"\xff\"").find("invalid JSON"), std::string::npos);
}

TEST(Json, NestingHasALimit) {
  const auto nested = [](size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_EQ(refusal(nested(deepest_json)), "");
  EXPECT_EQ(refusal(nested(deepest_json + 1)), "a.json: objects and arrays nest deeper than 128 levels");
  std::string objects;
  for (int i = 0; i < 1'000'000; ++i) objects += R"({"a":)";
  EXPECT_EQ(refusal(objects), "a.json: objects and arrays nest deeper than 128 levels");
}

TEST(Json, MembersOfAnObjectThatKeepsItsOrderHaveALimit) {
  std::string text = "{";
  for (int i = 0; i < 1'000'000; ++i) text += fmt::format("{}\"k{}\":0", i ? "," : "", i);
  EXPECT_NE(refusal(text + "}").find("more than 10000 members"), std::string::npos) << refusal(text + "}");
}

}  // namespace
}  // namespace candela
