#include "glsl/built_in_spirv.h"

#include <algorithm>
#include <cstring>

namespace candela::glsl {

std::vector<std::byte> spirv_table(const std::vector<std::pair<Hash128, std::vector<uint32_t>>>& shaders) {
  std::vector<const std::pair<Hash128, std::vector<uint32_t>>*> sorted;
  for (const auto& shader : shaders) sorted.push_back(&shader);
  std::ranges::sort(sorted, {}, [](const auto* shader) { return shader->first; });
  const auto twins = std::ranges::unique(sorted, {}, [](const auto* shader) { return shader->first; });
  sorted.erase(twins.begin(), twins.end());

  const uint64_t count = sorted.size();
  std::vector<BuiltIn> rows;
  uint64_t end = sizeof count + count * sizeof(BuiltIn);
  for (const auto* shader : sorted) {
    rows.push_back({shader->first, end, shader->second.size()});
    end += shader->second.size() * sizeof(uint32_t);
  }
  std::vector<std::byte> table(end);
  std::memcpy(table.data(), &count, sizeof count);
  if (count > 0) std::memcpy(table.data() + sizeof count, rows.data(), count * sizeof(BuiltIn));
  for (size_t i = 0; i < count; ++i)
    std::memcpy(table.data() + rows[i].offset, sorted[i]->second.data(), rows[i].words * sizeof(uint32_t));
  return table;
}

std::vector<std::string> listed_shaders(std::string_view text) {
  std::vector<std::string> names;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    line = line.substr(0, line.find("//"));
    while (line.ends_with(' ') || line.ends_with('\r')) line.remove_suffix(1);
    if (!line.empty()) names.emplace_back(line);
  }
  return names;
}

std::optional<std::vector<uint32_t>> find_spirv(std::span<const std::byte> table, const Hash128& key) {
  uint64_t first = 0, last = 0;
  if (table.size() < sizeof last) return std::nullopt;
  std::memcpy(&last, table.data(), sizeof last);
  while (first < last) {
    const uint64_t middle = first + (last - first) / 2;
    BuiltIn row;
    std::memcpy(&row, table.data() + sizeof last + middle * sizeof row, sizeof row);
    if (row.key == key) {
      std::vector<uint32_t> words(row.words);
      std::memcpy(words.data(), table.data() + row.offset, row.words * sizeof(uint32_t));
      return words;
    }
    if (row.key < key)
      first = middle + 1;
    else
      last = middle;
  }
  return std::nullopt;
}

}  // namespace candela::glsl
