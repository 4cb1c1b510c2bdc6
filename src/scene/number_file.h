#pragma once
#include <filesystem>
#include <initializer_list>
#include <vector>

#include "base/error.h"

namespace candela {

// A text of numbers, separated by blanks, a few in each line. Empty lines and what follows a # count for nothing.
struct NumberLine {
  size_t line = 0;  // from 1
  std::vector<double> values;
};
// counts: how many numbers a line may have; what: in words, "a point is three numbers: x y z". Errors (input) name file
// and line: another count, what is no number, is not finite, or no line at all.
Expected<std::vector<NumberLine>> read_number_file(const std::filesystem::path& file,
                                                   std::initializer_list<size_t> counts, const char* what);
// The place of a line for messages: "path.txt:3".
std::string line_place(const std::filesystem::path& file, size_t line);

}  // namespace candela
