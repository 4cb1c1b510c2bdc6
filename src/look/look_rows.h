#pragma once
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/text.h"
#include "look/look.h"

// Tables of a look file's keys: each row says what it is (look_keys() shows it) and reads it into a T.
namespace candela::look_rows {

using Json = nlohmann::ordered_json;

inline std::unexpected<Error> wrong(const std::string& place, const std::string& what) {
  return std::unexpected(Error{ErrorKind::input, what, place});
}

template <class T>
struct Row {
  LookKey key;
  std::function<Expected<void>(const Json&, const std::string& place, T&)> read;
};
template <class T>
using Rows = std::vector<Row<T>>;

template <class T>
Expected<void> read_rows(const Json& j, const std::string& place, const Rows<T>& rows, T& into) {
  if (!j.is_object()) return wrong(place, "the value is not an object");
  for (const auto& [key, value] : j.items()) {
    const std::string at = place + "/" + key;
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row<T>& r) { return r.key.name == key; });
    if (row == rows.end()) {
      std::vector<std::string> names;
      for (const Row<T>& known : rows) names.push_back(known.key.name);
      return wrong(at, unknown_name("key", key, names));
    }
    if (auto read = row->read(value, at, into); !read) return read;
  }
  return {};
}

struct Range {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool above_low = false;
};
inline Range from_zero() { return {.low = 0}; }
inline Range above_zero() { return {.low = 0, .above_low = true}; }
inline Range between(double low, double high) { return {.low = low, .high = high}; }

// A number that 32 bits hold, within the range.
Expected<double> number(const Json& j, const std::string& place, Range range = {});
// One number for all channels, or three; each of at least 0.
Expected<glm::dvec3> color(const Json& j, const std::string& place, Range range = from_zero());

inline LookKey key_of(std::string name, LookKey::Kind kind, Range range, std::string help) {
  LookKey key{.name = std::move(name), .help = std::move(help), .kind = kind};
  key.low = range.low, key.high = range.high, key.above_low = range.above_low;
  return key;
}

// `member` reaches from a T what takes the value: a pointer to a member, or a function.
template <class T, class Member>
Row<T> number_row(std::string name, Range range, Member member, std::string help) {
  return {key_of(std::move(name), LookKey::Kind::number, range, std::move(help)),
          [=](const Json& j, const std::string& place, T& into) -> Expected<void> {
            const auto value = number(j, place, range);
            if (!value) return std::unexpected(value.error());
            std::invoke(member, into) = *value;
            return {};
          }};
}
template <class T, class Member>
Row<T> color_row(std::string name, Range range, Member member, std::string help) {
  return {key_of(std::move(name), LookKey::Kind::color, range, std::move(help)),
          [=](const Json& j, const std::string& place, T& into) -> Expected<void> {
            const auto value = color(j, place, range);
            if (!value) return std::unexpected(value.error());
            std::invoke(member, into) = *value;
            return {};
          }};
}
// x, y and z, the same at all times.
template <class T, class Member>
Row<T> point_row(std::string name, Member member, std::string help) {
  LookKey key = key_of(std::move(name), LookKey::Kind::numbers, {}, std::move(help));
  key.least = key.most = 3, key.fixed = true;
  return {std::move(key), [=](const Json& j, const std::string& place, T& into) -> Expected<void> {
            if (!j.is_array() || j.size() != 3)
              return wrong(place, "the value is not a list of three numbers: x, y, z");
            glm::dvec3 point;
            for (int c = 0; c < 3; ++c) {
              const auto value = number(j[size_t(c)], fmt::format("{}/{}", place, c));
              if (!value) return std::unexpected(value.error());
              point[c] = *value;
            }
            std::invoke(member, into) = point;
            return {};
          }};
}
template <class T>
Row<T> fixed_row(Row<T> row) {
  row.key.fixed = true;
  return row;
}
template <class T, class Member>
Row<T> flag_row(std::string name, Member member, std::string help) {
  return {key_of(std::move(name), LookKey::Kind::flag, {}, std::move(help)),
          [=](const Json& j, const std::string& place, T& into) -> Expected<void> {
            if (!j.is_boolean()) return wrong(place, "the value is neither true nor false");
            std::invoke(member, into) = j.get<bool>();
            return {};
          }};
}
// choices: the texts that there are; empty: any that is not empty.
template <class T, class Member>
Row<T> text_row(std::string name, std::vector<std::string> choices, Member member, std::string help) {
  LookKey key = key_of(std::move(name), LookKey::Kind::text, {}, std::move(help));
  key.choices = choices;
  return {std::move(key), [=](const Json& j, const std::string& place, T& into) -> Expected<void> {
            if (!j.is_string() || j.get<std::string>().empty()) return wrong(place, "the value is not a text");
            const std::string text = j.get<std::string>();
            if (!choices.empty() && std::find(choices.begin(), choices.end(), text) == choices.end())
              return wrong(place, unknown_name("value", text, choices));
            std::invoke(member, into) = text;
            return {};
          }};
}
// done: checks what was read as a whole and hands it on.
template <class T, class Part>
Row<T> object_row(std::string name, const Rows<Part>& rows, std::function<Part(T&)> start,
                  std::function<Expected<void>(const Json&, const std::string& place, Part&, T&)> done,
                  std::string help) {
  LookKey key = key_of(std::move(name), LookKey::Kind::object, {}, std::move(help));
  for (const Row<Part>& row : rows) key.keys.push_back(row.key);
  return {std::move(key), [=](const Json& j, const std::string& place, T& into) -> Expected<void> {
            Part part = start(into);
            if (auto read = read_rows(j, place, rows, part); !read) return read;
            return done(j, place, part, into);
          }};
}

// A list of objects, each as object_row() reads one.
template <class T, class Part>
Row<T> objects_row(std::string name, size_t most, const Rows<Part>& rows,
                   std::function<Expected<void>(const Json&, const std::string& place, Part&, T&)> done,
                   std::string help) {
  LookKey key = key_of(std::move(name), LookKey::Kind::objects, {}, std::move(help));
  key.most = most;
  for (const Row<Part>& row : rows) key.keys.push_back(row.key);
  return {std::move(key), [=](const Json& j, const std::string& place, T& into) -> Expected<void> {
            if (!j.is_array()) return wrong(place, "the value is not a list of objects");
            if (j.size() > most)
              return wrong(place, fmt::format("the list holds {} values; {} at most", j.size(), most));
            for (size_t i = 0; i < j.size(); ++i) {
              Part part;
              const std::string at = fmt::format("{}/{}", place, i);
              if (auto read = read_rows(j[i], at, rows, part); !read) return read;
              if (auto kept = done(j[i], at, part, into); !kept) return kept;
            }
            return {};
          }};
}

const Rows<Look>& look_table();  // all rows of a look; look.cpp
Row<Look> fog_row();             // look_fog.cpp
Row<Look> volumetric_row();
Row<Look> probes_row();  // look_probes.cpp
Row<Look> paths_row();   // look_motion.cpp
Row<Look> instances_row();
// Keys over time in it are an error (input): it says what does not change. what: in words, "probes are".
Expected<void> check_fixed(const Json& j, const std::string& place, const std::string& what);

// A value of a look that changes over time: {"keys": [[time in seconds, value], ...]} as it was read.
enum class Between : uint8_t { linear, step, cubic };
struct TimedValue {
  Json::json_pointer at;  // where in the look it stands
  bool is_list = false;   // else a number
  Between between = Between::linear;
  std::vector<double> time_s;                   // ascending
  std::vector<std::vector<double>> components;  // of a list its numbers, of a number one; each as long as time_s
  // Puts what it is at a time in its place.
  void set(Json& tree, double time_s) const;
};
// Takes {"keys": ...} out wherever they stand in j, and leaves their first values. at: of j in the look.
Expected<void> take_timed_values(Json& j, const std::string& place, const Json::json_pointer& at,
                                 std::vector<TimedValue>& values);

}  // namespace candela::look_rows
