#include "base/text.h"

#include <fmt/format.h>

#include <algorithm>

namespace candela {

std::string joined(std::span<const std::string> words, std::string_view separator) {
  return fmt::format("{}", fmt::join(words.begin(), words.end(), separator));
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (size_t begin = 0;;) {
    const size_t end = text.find(separator, begin);
    parts.emplace_back(text.substr(begin, end == std::string_view::npos ? end : end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

namespace {
size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}
}  // namespace

std::string nearest_name(std::string_view word, std::span<const std::string> names) {
  std::string best;
  size_t best_distance = std::max<size_t>(2, word.size() / 3) + 1;
  for (const std::string& name : names) {
    const bool begins = word.size() >= 3 && name.starts_with(word);
    const size_t distance = begins ? 1 : edit_distance(word, name);
    if (distance < best_distance && distance < name.size()) best = name, best_distance = distance;
  }
  return best;
}

std::string unknown_name(std::string_view what, std::string_view word, std::span<const std::string> names) {
  const std::string near = nearest_name(word, names);
  return fmt::format("unknown {} '{}'{} There {}: {}", what, word,
                     near.empty() ? "." : fmt::format("; did you mean '{}'?", near), names.size() == 1 ? "is" : "are",
                     names.empty() ? "none" : joined(names));
}

}  // namespace candela
