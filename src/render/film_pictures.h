#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"

namespace candela {

// Pictures that are there, in the order of a film.
struct FilmPictures {
  std::vector<std::string> files;
  std::vector<int64_t> numbers;  // of the files; none where they were listed by name
};

// What `words` name: one pattern ('out/%04d.png'), one folder, whose PNG files all have one name and different numbers,
// or files in this order. Errors: usage; input where nothing is there.
Expected<FilmPictures> film_pictures(const std::vector<std::string>& words);

// The numbers between the first and the last that are not there, "4-6, 9"; empty: none. The step is the smallest
// between neighbours, so that every second frame is no gap.
std::string missing_numbers(const std::vector<int64_t>& numbers);

}  // namespace candela
