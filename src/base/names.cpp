#include "base/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <set>

#include "base/hash.h"

namespace candela {
namespace {

// The code point that a text begins with, and its bytes; 0 bytes: it is no UTF-8.
struct CodePoint {
  uint32_t value = 0;
  size_t bytes = 0;
};
CodePoint first_of(std::string_view text) {
  const auto byte = [&](size_t i) { return uint32_t(static_cast<unsigned char>(text[i])); };
  const uint32_t first = byte(0);
  if (first < 0x80) return {first, 1};
  const size_t bytes = first >= 0xf0 && first < 0xf5 ? 4 : first >= 0xe0 ? 3 : first >= 0xc2 ? 2 : 0;
  if (bytes == 0 || first >= 0xf5 || text.size() < bytes) return {};
  uint32_t value = first & (0x7fu >> bytes);
  for (size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {};
    value = value << 6 | (byte(i) & 0x3f);
  }
  constexpr uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = value >= 0xd800 && value < 0xe000;
  if (value < least[bytes] || value > 0x10ffff || is_surrogate) return {};
  return {value, bytes};
}

// Controls, line and paragraph separators, and what changes the direction of text (Unicode 15, Bidi_Control).
bool is_hidden(uint32_t c) {
  return c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0x61c || c == 0x200e || c == 0x200f ||
         (c >= 0x2028 && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069) || c == 0xfeff;
}

std::string escaped(uint32_t c) {
  switch (c) {
    case '\n':
      return "\\n";
    case '\r':
      return "\\r";
    case '\t':
      return "\\t";
    default:
      return c < 0x100 ? fmt::format("\\x{:02x}", c) : fmt::format("\\u{:04x}", c);
  }
}

// Character by character: put(what it reads as).
template <class Put>
void each_character(std::string_view text, Put put) {
  while (!text.empty()) {
    const CodePoint c = first_of(text);
    const size_t bytes = std::max<size_t>(c.bytes, 1);
    if (c.bytes == 0)
      put(escaped(static_cast<unsigned char>(text.front())));
    else
      put(is_hidden(c.value) ? escaped(c.value) : std::string(text.substr(0, bytes)));
    text.remove_prefix(bytes);
  }
}

constexpr size_t most_shown = 80, most_bytes = 80, hash_digits = 8;

std::string lower(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string result;
  each_character(text, [&](const std::string& character) { result += character; });
  return result;
}

std::string quoted_name(std::string_view name) {
  std::string result = "'";
  size_t shown = 0;
  each_character(name, [&](const std::string& character) {
    if (++shown > most_shown) return;
    if (character == "'" || character == "\\") result += '\\';
    result += character;
  });
  return result + (shown > most_shown ? "...'" : "'");
}

std::string file_name_part(std::string_view name) {
  std::string part;
  for (std::string_view rest = name; !rest.empty();) {
    const CodePoint c = first_of(rest);
    const bool plain = c.value < 0x80
                           ? std::isalnum(int(c.value)) ||
                                 (c.value != 0 && std::string_view("._-").find(char(c.value)) != std::string_view::npos)
                           : !is_hidden(c.value);
    const size_t bytes = std::max<size_t>(c.bytes, 1);
    part += c.bytes > 0 && plain ? std::string(rest.substr(0, bytes)) : "_";
    rest.remove_prefix(bytes);
  }
  if (part.empty()) return "_";
  if (part.front() == '.' || part.front() == '-') part.front() = '_';
  if (part.size() <= most_bytes) return part;
  size_t cut = most_bytes - hash_digits - 1;
  while ((static_cast<unsigned char>(part[cut]) & 0xc0) == 0x80) --cut;  // not inside a character
  return part.substr(0, cut) + "-" + hash128(std::string(name)).hex().substr(0, hash_digits);
}

std::vector<std::string> file_name_parts(const std::vector<std::string>& names) {
  std::vector<std::string> parts;
  std::set<std::string> taken;
  for (const std::string& name : names) {
    const std::string part = file_name_part(name);
    std::string unique = part;
    for (int n = 2; !taken.insert(lower(unique)).second; ++n) unique = fmt::format("{}-{}", part, n);
    parts.push_back(std::move(unique));
  }
  return parts;
}

}  // namespace candela
