#include "job/background.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>

#include "base/text.h"

namespace candela {
namespace {

// CSS Color Module Level 4, "Basic color keywords", and the few beside them that pictures stand before.
const std::map<std::string_view, uint32_t>& named_colors() {
  static const std::map<std::string_view, uint32_t> names = {
      {"white", 0xffffff},      {"silver", 0xc0c0c0},    {"gray", 0x808080},     {"grey", 0x808080},
      {"black", 0x000000},      {"red", 0xff0000},       {"maroon", 0x800000},   {"yellow", 0xffff00},
      {"olive", 0x808000},      {"lime", 0x00ff00},      {"green", 0x008000},    {"aqua", 0x00ffff},
      {"cyan", 0x00ffff},       {"teal", 0x008080},      {"blue", 0x0000ff},     {"navy", 0x000080},
      {"fuchsia", 0xff00ff},    {"magenta", 0xff00ff},   {"purple", 0x800080},   {"orange", 0xffa500},
      {"lightgray", 0xd3d3d3},  {"lightgrey", 0xd3d3d3}, {"darkgray", 0xa9a9a9}, {"darkgrey", 0xa9a9a9},
      {"whitesmoke", 0xf5f5f5}, {"ivory", 0xfffff0},     {"beige", 0xf5f5dc},    {"skyblue", 0x87ceeb}};
  return names;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = char(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

// #rgb means #rrggbb.
std::optional<uint32_t> hex_color(std::string_view text) {
  uint32_t value = 0;
  const char* const begin = text.data() + 1;
  const char* const end = text.data() + text.size();
  if ((text.size() != 4 && text.size() != 7) || text[0] != '#') return {};
  const auto [at, error] = std::from_chars(begin, end, value, 16);
  if (error != std::errc() || at != end) return {};
  if (text.size() == 7) return value;
  const uint32_t r = value >> 8, g = value >> 4 & 15, b = value & 15;
  return (r << 16 | g << 8 | b) * 17;
}

std::optional<std::array<float, 4>> linear_color(const std::string& text) {
  std::array<float, 4> color{0, 0, 0, 1};
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 3) return {};
  for (size_t i = 0; i < 3; ++i) {
    const char* const end = parts[i].data() + parts[i].size();
    const auto [at, error] = std::from_chars(parts[i].data(), end, color[i]);
    if (error != std::errc() || at != end || !(color[i] >= 0) || !std::isfinite(color[i])) return {};
  }
  return color;
}

}  // namespace

Expected<BackgroundChoice> parse_background(const std::string& text) {
  const std::string word = lower(text);
  if (word == "transparent") return BackgroundChoice{};
  if (const auto named = named_colors().find(word); named != named_colors().end())
    return BackgroundChoice{.display_rgb = named->second};
  if (const auto hex = hex_color(word)) return BackgroundChoice{.display_rgb = *hex};
  if (const auto linear = linear_color(text)) return BackgroundChoice{.linear = *linear};
  return fail(
      ErrorKind::usage, "--background",
      "'{}' is none of transparent, a colour of the display (white, black, grey, #fff, #1e90ff), and three linear "
      "values R,G,B of at least 0",
      text);
}

}  // namespace candela
