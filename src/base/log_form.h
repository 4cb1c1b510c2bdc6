#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

// How lines of the log look (base/log.h, which is in every file, stays without this).
namespace candela::log {

// json: an object a line (docs/schemas/log.schema.json), for programs that follow jobs.
enum class Form : uint8_t { text, json };
void set_form(Form form);
Form form();

// The last lines of all levels, shown or not, without color; at most 1,000.
std::vector<std::string> recent_lines();

// A line of the kind `event` with members of its own beside time, level, event and text: as JSON. In text form `text`
// alone, whole as it is given: the caller ends the line or writes over it.
void event(std::string_view event, std::string_view text, const nlohmann::ordered_json& members);

}  // namespace candela::log
