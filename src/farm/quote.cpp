#include "farm/quote.h"

#include <fmt/format.h>

#include <algorithm>

namespace candela {
namespace {

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("_-./,:=+@%").find(c) != std::string_view::npos;
}

bool is_control(char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }

}  // namespace

std::string shell_quoted(std::string_view word) {
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return std::string(word);
  std::string quoted = "'";
  for (const char c : word)
    if (c == '\'')
      quoted += "'\\''";
    else
      quoted += c;
  return quoted + "'";
}

std::string shell_quoted(std::span<const std::string> words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_quoted(word);
  return line;
}

std::string argument_lines(std::span<const std::string> words, std::string_view indent, std::string_view end) {
  std::string text;
  for (size_t i = 0; i < words.size(); ++i) {
    const bool with_value = words[i].starts_with('-') && words[i].find('=') == std::string::npos &&
                            i + 1 < words.size() && !words[i + 1].starts_with('-');
    text += fmt::format("{}{}{}{}\n", indent, shell_quoted(words[i]),
                        with_value ? " " + shell_quoted(words[i + 1]) : "", end);
    i += with_value;
  }
  return text;
}

std::string python_quoted(std::string_view text) {
  std::string quoted = "'";
  for (const char c : text)
    if (c == '\'' || c == '\\')
      quoted += std::string("\\") + c;
    else if (is_control(c))
      quoted += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else
      quoted += c;
  return quoted + "'";
}

std::string recipe_text(std::string_view text) {
  std::string doubled;
  for (const char c : text) doubled += c == '$' ? "$$" : std::string(1, c);
  return doubled;
}

std::string recipe_quoted(std::string_view word) { return recipe_text(shell_quoted(word)); }

std::string comment_text(std::string_view text) {
  std::string line(text);
  std::replace_if(line.begin(), line.end(), is_control, '?');
  return line;
}

std::string plain_name(std::string_view text) {
  std::string name(text);
  for (char& c : name)
    if (!is_plain(c) || std::string_view("/,:=+@%").find(c) != std::string_view::npos) c = '_';
  return name;
}

}  // namespace candela
