// The schema in docs/schemas and the reader of look files know the same keys with the same limits.
#include <gtest/gtest.h>

#include <set>

#include "base/files.h"
#include "base/json.h"
#include "look/look.h"

namespace candela::test::scene_look_schema {
namespace {

using Json = nlohmann::ordered_json;

Json schema_file() {
  const auto read = read_json_file(CANDELA_SOURCE_DIR "/docs/schemas/look.schema.json");
  EXPECT_TRUE(read) << read.error().text();
  return read ? *read : Json();
}

void collect(const Json& schema, const std::string& at, std::map<std::string, Json>& leaves) {
  if (schema.contains("properties"))
    for (const auto& [name, value] : schema["properties"].items()) collect(value, at + "/" + name, leaves);
  else
    leaves[at] = schema;
}
void collect(const std::vector<LookKey>& keys, const std::string& at, std::map<std::string, LookKey>& leaves) {
  for (const LookKey& key : keys)
    if (key.kind == LookKey::Kind::object)
      collect(key.keys, at + "/" + key.name, leaves);
    else
      leaves[at + "/" + key.name] = key;
}

// {"fog": {"extinction": value}} of "/fog/extinction".
std::string document(const std::string& path, const Json& value) {
  Json j;
  j[Json::json_pointer(path)] = value;
  return j.dump();
}
std::string error_of(const std::string& text) {
  const auto look = look_from_json(text, "l.json");
  return look ? "" : look.error().text();
}

}  // namespace

TEST(LookSchema, IsTheReadersOwn) {
  EXPECT_EQ(schema_file(), own_json(look_schema())) << "candela list look-schema > docs/schemas/look.schema.json";
}

TEST(LookSchema, AndTheReaderKnowTheSameKeys) {
  std::map<std::string, Json> in_schema;
  std::map<std::string, LookKey> in_reader;
  collect(schema_file(), "", in_schema);
  collect(look_keys(), "", in_reader);
  std::set<std::string> schema_names, reader_names;
  for (const auto& [path, schema] : in_schema) schema_names.insert(path);
  for (const auto& [path, key] : in_reader) reader_names.insert(path);
  EXPECT_EQ(schema_names, reader_names);
  EXPECT_GT(schema_names.size(), 40u);
  // What the reader really does with each: no key of the schema is unknown to it, every limit holds.
  for (const auto& [path, key] : in_reader) {
    const std::string place = "l.json: " + path;
    EXPECT_EQ(error_of(document(path, Json(1))).find("unknown key"), std::string::npos) << path;
    EXPECT_NE(error_of(document(path + "x", Json(1))).find("unknown key"), std::string::npos) << path;
    EXPECT_NE(error_of(document(path, Json::object())).find(place), std::string::npos) << path;
    if (key.kind != LookKey::Kind::number && key.kind != LookKey::Kind::color) continue;
    const auto refused = [&](double value) { return error_of(document(path, value)).find(place) != std::string::npos; };
    if (std::isfinite(key.low)) EXPECT_TRUE(refused(key.low - 1)) << path;
    if (std::isfinite(key.low)) EXPECT_EQ(refused(key.low), key.above_low) << path;
    const bool other_reason = path == "/fog/albedo";  // checked with its fellows
    if (std::isfinite(key.high) && !other_reason) EXPECT_TRUE(refused(key.high + 1)) << path;
    if (std::isfinite(key.high)) EXPECT_FALSE(refused(key.high)) << path;
  }
}

TEST(LookSchema, SaysWhatStandsInTheSchema) {
  const Json schema = schema_file();
  const Json& radius = schema.at(Json::json_pointer("/properties/occlusion/properties/radius_m/anyOf"));
  EXPECT_EQ(radius[0]["exclusiveMinimum"], 0);
  EXPECT_EQ(radius[1]["properties"]["interpolation"]["enum"], Json({"linear", "step", "cubic"}));
  EXPECT_EQ(schema["additionalProperties"], false);
}

}  // namespace candela::test::scene_look_schema
