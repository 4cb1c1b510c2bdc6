#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "gltf/validate/validate.h"

namespace candela {
namespace {

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::string u32(uint32_t value) {
  std::string text(4, '\0');
  std::memcpy(text.data(), &value, 4);
  return text;
}
std::string chunk(const char* type, const std::string& data) {
  return u32(uint32_t(data.size())) + std::string(type, 4) + data;
}
std::string glb(const std::string& chunks, uint32_t version = 2, int extra = 0) {
  return "glTF" + u32(version) + u32(uint32_t(12 + int(chunks.size()) + extra)) + chunks;
}

std::string split_error(const std::string& file, const std::string& name = "a.glb") {
  std::vector<Finding> findings;
  const auto parts = split_gltf(bytes_of(file), name, findings);
  return parts ? "" : parts.error().text();
}

const std::string json_chunk = chunk("JSON", "{\"a\": 1}"),
                  bin_chunk = chunk(std::string("BIN\0", 4).data(), "12345678");

TEST(SplitGltf, GivesJsonAndBinary) {
  const std::string file = glb(json_chunk + bin_chunk);
  std::vector<Finding> findings;
  const auto parts = split_gltf(bytes_of(file), "a", findings);
  ASSERT_TRUE(parts);
  EXPECT_TRUE(parts->is_glb && parts->has_binary && findings.empty());
  EXPECT_EQ(parts->json.size(), 8u);
  EXPECT_EQ(parts->binary.size(), 8u);
  EXPECT_EQ(char(parts->binary[0]), '1');
}

TEST(SplitGltf, PassesTextThrough) {
  std::vector<Finding> findings;
  const std::string text = "{}";
  const auto parts = split_gltf(bytes_of(text), "a.gltf", findings);
  ASSERT_TRUE(parts);
  EXPECT_FALSE(parts->is_glb);
  EXPECT_EQ(parts->json.size(), 2u);
}

TEST(SplitGltf, NamesWhatIsBroken) {
  const std::pair<std::string, const char*> broken[] = {
      {"", "GLB_UNEXPECTED_END_OF_HEADER"},
      {"glTF\2", "GLB_UNEXPECTED_END_OF_HEADER"},
      {"what is this", "GLB_INVALID_MAGIC"},
      {glb(json_chunk, 1), "GLB_INVALID_VERSION"},
      {glb(""), "GLB_LENGTH_TOO_SMALL"},
      {glb(json_chunk, 2, 4), "GLB_LENGTH_MISMATCH"},
      {glb(json_chunk, 2, -4), "GLB_CHUNK_TOO_BIG"},
      {glb(bin_chunk), "GLB_UNEXPECTED_FIRST_CHUNK"},
      {glb(chunk("JSON", "")), "GLB_EMPTY_CHUNK"},
      {glb(json_chunk + json_chunk), "GLB_DUPLICATE_CHUNK"},
      {glb(json_chunk + bin_chunk + bin_chunk), "GLB_DUPLICATE_CHUNK"},
      {glb(json_chunk + chunk("ODD ", "1234") + bin_chunk), "GLB_UNEXPECTED_BIN_CHUNK"},
      {glb(u32(0xFFFFFFFC) + "JSON"), "GLB_CHUNK_TOO_BIG"},
  };
  for (const auto& [file, code] : broken)
    EXPECT_NE(split_error(file).find(code), std::string::npos) << code << ": " << split_error(file);
}

TEST(SplitGltf, EveryTruncationIsAnError) {
  const std::string file = glb(json_chunk + bin_chunk);
  for (size_t n = 0; n < file.size(); ++n) EXPECT_NE(split_error(file.substr(0, n)), "") << n;
  EXPECT_NE(split_error(file.substr(0, file.size() - 1)).find("GLB_UNEXPECTED_END_OF_CHUNK_DATA"), std::string::npos);
}

TEST(SplitGltf, OddButUsableIsAWarning) {
  for (const auto& [file, code] : {std::pair{glb(json_chunk) + "tail", "GLB_EXTRA_DATA"},
                                   {glb(json_chunk + chunk("ODD ", "1234")), "GLB_UNKNOWN_CHUNK_TYPE"}}) {
    std::vector<Finding> findings;
    ASSERT_TRUE(split_gltf(bytes_of(file), "a.glb", findings));
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].code, code);
    EXPECT_FALSE(findings[0].fatal);
  }
}

std::string parse_error(const std::string& text) {
  const auto document = parse_gltf_json(bytes_of(text), "a.gltf");
  return document ? "" : document.error().text();
}

TEST(ParseGltfJson, WholeNumbersBecomeIntegers) {
  const auto document =
      parse_gltf_json(bytes_of(R"({"a": [1.0, 2e0, 30e-1, -4.0, 1.5, 1e300, 9007199254740993]})"), "a");
  ASSERT_TRUE(document);
  const auto& a = (*document)["a"];
  for (size_t i = 0; i < 4; ++i) EXPECT_TRUE(a[i].is_number_integer()) << i;
  EXPECT_EQ(a[2], 3);
  EXPECT_EQ(a[3], -4);
  EXPECT_TRUE(a[4].is_number_float() && a[5].is_number_float());
  EXPECT_EQ(a[6], 9007199254740993);
}

TEST(ParseGltfJson, BuildsNestedDocuments) {
  const std::string text = R"({"a":[{"b":[[1,2],{"c":null}],"d":"e"},true],"f":{"g":{}}})";
  const auto document = parse_gltf_json(bytes_of(text), "a");
  ASSERT_TRUE(document);
  EXPECT_EQ(*document, nlohmann::json::parse(text));
}

TEST(ParseGltfJson, RefusesWhatIsNotJson) {
  const std::string nul("{\"a\": \"\0\"}", 10);
  for (const std::string& text :
       {std::string(), std::string(" "), std::string("{"), std::string("{\"a\" 1}"), std::string("[1,]"),
        std::string("{} {}"), std::string("nan"), std::string("{\"a\": \"\xff\"}"),
        std::string("{\"a\": \"\xc0\xaf\"}"), std::string("{\"a\": \"\xed\xa0\x80\"}"), std::string("{\"a\": 01}"),
        std::string("\xff\xfe{\0}\0", 6), nul})
    EXPECT_NE(parse_error(text).find("(INVALID_JSON)"), std::string::npos) << text;
}

TEST(ParseGltfJson, SaysThatAnotherFormatHasToBeConverted) {
  EXPECT_NE(parse_error("# cube\nv 0 0 0\n").find("converted"), std::string::npos);
  EXPECT_EQ(parse_error("{\"a\" 1}").find("converted"), std::string::npos);
}

TEST(ParseGltfJson, RefusesByteOrderMark) {
  EXPECT_NE(parse_error("\xEF\xBB\xBF{}").find("byte order mark"), std::string::npos);
}

TEST(ParseGltfJson, NamesADuplicateKeyAndItsPlace) {
  const std::string error = parse_error(R"({"x": [0, {"k": 1, "k": 2}]})");
  EXPECT_NE(error.find("/x/1/k"), std::string::npos) << error;
  EXPECT_NE(error.find("twice"), std::string::npos) << error;
}

TEST(ParseGltfJson, NamesANumberBeyondDouble) {
  const std::string error = parse_error(R"({"nodes": [{}, {"translation": [0, 1e999, 0]}]})");
  EXPECT_NE(error.find("/nodes/1/translation/1"), std::string::npos) << error;
  EXPECT_NE(error.find("(VALUE_NOT_IN_RANGE)"), std::string::npos) << error;
}

TEST(ParseGltfJson, DeepNestingIsRefusedWithoutRecursion) {
  for (const size_t depth : {size_t(129), size_t(100000), size_t(5000000)}) {
    EXPECT_NE(parse_error(std::string(depth, '[')).find("nest deeper"), std::string::npos);
    std::string objects;
    for (size_t i = 0; i < std::min(depth, size_t(100000)); ++i) objects += "{\"a\":";
    EXPECT_NE(parse_error(objects).find("nest deeper"), std::string::npos);
  }
  EXPECT_EQ(parse_error(std::string(128, '[') + std::string(128, ']')), "");
}

TEST(ParseGltfJson, EveryTruncationIsAnError) {
  const std::string text = R"({"asset":{"version":"2.0"},"nodes":[{"name":"\u00e9","translation":[1.5,-2e3,0]}]})";
  for (size_t n = 0; n < text.size(); ++n) EXPECT_NE(parse_error(text.substr(0, n)), "") << n;
  EXPECT_EQ(parse_error(text), "");
}

}  // namespace
}  // namespace candela
