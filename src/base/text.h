#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace candela {

std::string joined(std::span<const std::string> words, std::string_view separator = ", ");
std::vector<std::string> split(std::string_view text,
                               char separator);  // "a,,b" gives "a", "", "b"; "" gives one empty part

// The name closest to `word` by edit distance (Levenshtein 1966), or empty when none is close enough to be a slip.
std::string nearest_name(std::string_view word, std::span<const std::string> names);

// "unknown technique 'brut-force'; did you mean 'brute-force'? There are: ..."
std::string unknown_name(std::string_view what, std::string_view word, std::span<const std::string> names);

}  // namespace candela
