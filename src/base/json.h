#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "base/error.h"

// The one reader of JSON: scenes, looks, suites, goldens, rows, jobs. Nothing else of the program parses any
// (tests/arch/check_tree.sh). Refused: bad syntax, bytes that are not UTF-8, a key twice in one object, numbers beyond
// a double, and what the limits say. Memory and time grow with the text.
namespace candela {

// Objects and arrays inside each other; readers of the value may recurse. glTF needs a few dozen levels.
inline constexpr size_t deepest_json = 128;
// Members of one object that keeps its order, whose members are searched one by one.
inline constexpr size_t most_ordered_members = 10'000;

struct JsonFault {
  std::string path, message;  // path: in the document, "/scenes/0"; empty where the parser knows the byte alone
  bool number_out_of_range = false;
};
// gltf: 1.0 and 1e0 come as integers, which glTF allows as indices and counts, and values of `extras`, which are the
// applications' own, are passed over however deep they nest.
enum class JsonDialect : uint8_t { plain, gltf };

// For nlohmann::json and nlohmann::ordered_json.
template <class Json>
std::expected<Json, JsonFault> parse_json(std::string_view text, JsonDialect dialect = JsonDialect::plain);

// Errors (input) name `place` and the path in the document: "suite.json: /scenes/0: ...".
Expected<nlohmann::ordered_json> read_json(std::string_view text, const std::string& place);
Expected<nlohmann::ordered_json> read_json_file(const std::filesystem::path& file);
// Of a text that the program itself has written.
nlohmann::ordered_json own_json(std::string_view text);

// A key as a part of a path: "/" and "~" are escaped (RFC 6901).
std::string pointer_token(std::string_view key);

}  // namespace candela
