#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/json.h"
#include "base/text.h"
#include "job/job.h"

// Reading of suite files: strict, and errors (input) name file and key.
namespace candela::suite_file {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// What reading one value needs to know of its surroundings.
struct SuitePlace {
  fs::path folder, assets;
  std::string at;  // file and JSON path, for messages
  SuitePlace inside(const std::string& key) const { return {folder, assets, at + "/" + key}; }
  std::unexpected<Error> wrong(const std::string& what) const {
    return std::unexpected(Error{ErrorKind::input, "the value " + what, at});
  }
};

template <class T>
using Readers = std::map<std::string, std::function<Expected<void>(const Json&, const SuitePlace&, T&)>>;

template <class T>
Expected<void> read_keys(const Json& j, const SuitePlace& place, const Readers<T>& readers, T& into) {
  if (!j.is_object()) return place.wrong("is not an object");
  for (const auto& [key, value] : j.items()) {
    const auto reader = readers.find(key);
    if (reader == readers.end()) {
      std::vector<std::string> names;
      for (const auto& entry : readers) names.push_back(entry.first);
      return fail(ErrorKind::input, place.at + "/" + key, "{}", unknown_name("key", key, names));
    }
    if (auto read = reader->second(value, place.inside(key), into); !read) return read;
  }
  return {};
}

inline Expected<void> read_text(const Json& j, const SuitePlace& place, std::string& into) {
  if (!j.is_string()) return place.wrong("is not a text");
  into = j.get<std::string>();
  return {};
}

template <class T>
Expected<void> read_whole(const Json& j, const SuitePlace& place, T lowest, T& into) {
  if (!j.is_number_integer() ||
      (j.is_number_unsigned() && j.get<uint64_t>() > uint64_t(std::numeric_limits<T>::max())) ||
      (!j.is_number_unsigned() && j.get<int64_t>() < int64_t(lowest)) ||
      (j.is_number_unsigned() && j.get<uint64_t>() < uint64_t(lowest)))
    return place.wrong(fmt::format("is not a whole number of at least {}", lowest));
  into = j.get<T>();
  return {};
}

inline Expected<void> read_positive(const Json& j, const SuitePlace& place, double& into) {
  if (!j.is_number() || !(j.get<double>() > 0)) return place.wrong("is not a number above 0");
  into = j.get<double>();
  return {};
}

// A list, or one value instead of a list of one. read(value, place) gives Expected<T>.
template <class T, class Read>
Expected<void> read_list(const Json& j, const SuitePlace& place, std::vector<T>& into, Read read) {
  const Json list = j.is_array() ? j : Json::array({j});
  if (list.empty()) return place.wrong("is an empty list");
  into.clear();
  for (size_t i = 0; i < list.size(); ++i) {
    auto value = read(list[i], j.is_array() ? place.inside(std::to_string(i)) : place);
    if (!value) return std::unexpected(value.error());
    into.push_back(std::move(*value));
  }
  return {};
}

template <class T>
auto whole_of(T lowest) {
  return [lowest](const Json& j, const SuitePlace& place) -> Expected<T> {
    T value{};
    if (auto read = read_whole(j, place, lowest, value); !read) return std::unexpected(read.error());
    return value;
  };
}

inline Expected<std::string> text_of(const Json& j, const SuitePlace& place) {
  std::string text;
  if (auto read = read_text(j, place, text); !read) return std::unexpected(read.error());
  return text;
}

inline Expected<std::pair<int, int>> size_of(const Json& j, const SuitePlace& place) {
  const auto text = text_of(j, place);
  if (!text) return std::unexpected(text.error());
  const auto size = parse_size(*text);
  if (!size) return std::unexpected(Error{ErrorKind::input, size.error().message, place.at});
  return *size;
}

}  // namespace candela::suite_file
