#include "render/film_pictures.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>

#include "render/frame_names.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

// The number of a frame in a text of digits.
std::optional<int64_t> number_in(std::string_view text) {
  int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

Expected<std::vector<fs::path>> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    if (at->is_regular_file(failed)) files.push_back(at->path());
  if (failed) return fail(ErrorKind::input, folder.string(), "cannot be listed: {}", failed.message());
  return files;
}

FilmPictures in_order(const std::map<int64_t, std::string>& by_number) {
  FilmPictures pictures;
  for (const auto& [number, file] : by_number) pictures.files.push_back(file), pictures.numbers.push_back(number);
  return pictures;
}

Expected<FilmPictures> of_pattern(const FramePattern& pattern) {
  const fs::path folder = fs::path(pattern.name(0)).parent_path();
  if (folder != fs::path(pattern.name(1)).parent_path())
    return fail(ErrorKind::usage, "FRAMES", "'{}' has the number in the name of a folder; name the files instead",
                pattern.given);
  const auto files = files_in(folder.empty() ? "." : folder);
  if (!files) return std::unexpected(files.error());
  std::map<int64_t, std::string> found;
  for (const fs::path& file : *files) {
    const std::string name = (folder / file.filename()).string();
    if (const auto number = pattern.frame_of(name)) found.emplace(*number, name);
  }
  if (found.empty()) return fail(ErrorKind::input, pattern.given, "there is no file of this name");
  return in_order(found);
}

Expected<FilmPictures> of_folder(const fs::path& folder) {
  const auto files = files_in(folder);
  if (!files) return std::unexpected(files.error());
  std::map<std::string, std::map<int64_t, std::string>> by_name;
  for (const fs::path& file : *files) {
    const auto format = output_format(file);
    const std::string stem = file.stem().string();
    const size_t digits = stem.find_last_not_of("0123456789") + 1;
    if (!format || *format != OutputFormat::png || digits == stem.size() || stem.starts_with(".candela-")) continue;
    if (const auto number = number_in(stem.substr(digits)))
      if (!by_name[stem.substr(0, digits)].emplace(*number, file.string()).second)
        return fail(ErrorKind::usage, "FRAMES", "'{}' holds frame {} twice; give a pattern such as '{}/%04d.png'",
                    folder.string(), *number, folder.string());
  }
  if (by_name.empty())
    return fail(ErrorKind::input, folder.string(),
                "holds no PNG file with a number; EXR frames make no film: "
                "write PNG beside them (-o 'out/%04d.png')");
  if (by_name.size() > 1)
    return fail(ErrorKind::usage, "FRAMES",
                "'{0}' holds frames of several names; give a pattern such as '{0}/{1}%04d.png'", folder.string(),
                by_name.begin()->first);
  return in_order(by_name.begin()->second);
}

}  // namespace

Expected<FilmPictures> film_pictures(const std::vector<std::string>& words) {
  if (words.empty())
    return fail(ErrorKind::usage, "FRAMES", "no frames given; write 'out/%04d.png', a folder, or the files");
  std::error_code failed;
  if (words.size() == 1 && fs::is_directory(words.front(), failed)) return of_folder(words.front());
  if (words.size() == 1 && !fs::exists(words.front(), failed)) {
    const auto pattern = parse_pattern(words.front());
    if (!pattern) return std::unexpected(Error{ErrorKind::usage, pattern.error().message, "FRAMES"});
    if (pattern->numbered) return of_pattern(*pattern);
  }
  return FilmPictures{words, {}};
}

std::string missing_numbers(const std::vector<int64_t>& numbers) {
  uint64_t step = 0;
  for (size_t i = 1; i < numbers.size(); ++i) {
    const uint64_t apart = uint64_t(numbers[i]) - uint64_t(numbers[i - 1]);
    if (step == 0 || apart < step) step = apart;
  }
  std::string text;
  constexpr int most_gaps = 10;
  int gaps = 0;
  for (size_t i = 1; i < numbers.size(); ++i) {
    const uint64_t apart = uint64_t(numbers[i]) - uint64_t(numbers[i - 1]);
    if (apart < 2 * step) continue;
    if (++gaps > most_gaps) return text + ", ...";
    const int64_t first = numbers[i - 1] + int64_t(step);
    const int64_t last = numbers[i - 1] + int64_t((apart - 1) / step * step);
    text += text.empty() ? "" : ", ";
    text += first >= last ? fmt::format("{}", first) : fmt::format("{}-{}", first, last);
    if (first < last && step > 1) text += fmt::format("x{}", step);
  }
  return text;
}

}  // namespace candela
