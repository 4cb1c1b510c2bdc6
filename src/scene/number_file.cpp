#include "scene/number_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "base/files.h"

namespace candela {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

std::string_view word_at(std::string_view& rest) {
  const size_t begin = std::min(rest.find_first_not_of(blanks), rest.size());
  rest.remove_prefix(begin);
  const std::string_view word = rest.substr(0, rest.find_first_of(blanks));
  rest.remove_prefix(word.size());
  return word;
}

// Names in messages are short, and text that cannot be shown is none of them.
std::string shown(std::string_view word) {
  std::string text(word.substr(0, 24));
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return word.size() > 24 ? text + "..." : text;
}

}  // namespace

std::string line_place(const std::filesystem::path& file, size_t line) {
  return fmt::format("{}:{}", file.string(), line);
}

Expected<std::vector<NumberLine>> read_number_file(const std::filesystem::path& file,
                                                   std::initializer_list<size_t> counts, const char* what) {
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::vector<NumberLine> lines;
  for (size_t number = 1; !text.empty(); ++number) {
    const size_t end = std::min(text.find('\n'), text.size());
    std::string_view rest = text.substr(0, std::min(text.substr(0, end).find('#'), end));
    text.remove_prefix(std::min(end + 1, text.size()));
    NumberLine line{number, {}};
    for (std::string_view word = word_at(rest); !word.empty(); word = word_at(rest)) {
      std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
      double value = 0;
      const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value);
      if (read.ec != std::errc() || read.ptr != digits.data() + digits.size() || !std::isfinite(value))
        return fail(ErrorKind::input, line_place(file, number), "'{}' is not a number; {}", shown(word), what);
      line.values.push_back(value);
    }
    if (line.values.empty()) continue;
    if (std::find(counts.begin(), counts.end(), line.values.size()) == counts.end())
      return fail(ErrorKind::input, line_place(file, number), "the line holds {} number{}; {}", line.values.size(),
                  line.values.size() == 1 ? "" : "s", what);
    lines.push_back(std::move(line));
  }
  if (lines.empty()) return fail(ErrorKind::input, file.string(), "holds no numbers; {}", what);
  return lines;
}

}  // namespace candela
