// Values over time.
#include <span>

#include "base/monotone_cubic.h"
#include "look/look_rows.h"

namespace candela::look_rows {
namespace {

// Checks the keys of one value; returns how many numbers each has, 0 for a plain number.
Expected<size_t> check_keys(const Json& keys, const std::string& place) {
  if (!keys.is_array() || keys.empty()) return wrong(place, "the value is not a list of [time, value]");
  double before = -std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < keys.size(); ++i) {
    const auto at = [&](const char* part = "") { return fmt::format("{}/{}{}", place, i, part); };
    const auto finite = [](const Json& n) { return n.is_number() && std::isfinite(float(n.get<double>())); };
    const Json& key = keys[i];
    if (!key.is_array() || key.size() != 2) return wrong(at(), "the value is not [time, value]");
    if (!finite(key[0])) return std::unexpected(number(key[0], at("/0")).error());
    const double time = key[0].get<double>();
    if (!(time > before)) return wrong(at("/0"), "the times do not ascend");
    before = time;
    const bool list = key[1].is_array();
    if (list != keys[0][1].is_array() || (list && key[1].size() != keys[0][1].size()))
      return wrong(at("/1"), "the value is of another kind than the first key's");
    for (size_t c = 0; c < (list ? key[1].size() : 1); ++c)
      if (const Json& value = list ? key[1][c] : key[1]; !finite(value))
        return std::unexpected(number(value, at("/1")).error());
  }
  return keys[0][1].is_array() ? keys[0][1].size() : 0;
}

Expected<Between> read_interpolation(const Json& j, const std::string& place) {
  const std::vector<std::string> names = {"linear", "step", "cubic"};
  if (!j.contains("interpolation")) return Between::linear;
  const Json& value = j["interpolation"];
  const std::string name = value.is_string() ? value.get<std::string>() : value.dump();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return wrong(place + "/interpolation", unknown_name("interpolation", name, names));
  return Between(found - names.begin());
}

// Between the keys i and i + 1.
double between_keys(std::span<const double> time, std::span<const double> value, size_t i, double time_s,
                    Between between) {
  const double a = value[i], b = value[i + 1], h = time[i + 1] - time[i], s = (time_s - time[i]) / h;
  if (between == Between::step) return a;
  if (between == Between::linear) return (1 - s) * a + s * b;
  return monotone_cubic(time, value, i, time_s);
}

TimedValue timed_value(const Json& keys, size_t numbers, Between between, const Json::json_pointer& at) {
  TimedValue value{.at = at, .is_list = keys[0][1].is_array(), .between = between, .time_s = {}, .components = {}};
  value.components.resize(value.is_list ? numbers : 1);
  value.time_s.reserve(keys.size());
  for (std::vector<double>& component : value.components) component.reserve(keys.size());
  for (const Json& key : keys) {
    value.time_s.push_back(key[0].get<double>());
    for (size_t c = 0; c < value.components.size(); ++c)
      value.components[c].push_back(value.is_list ? key[1][c].get<double>() : key[1].get<double>());
  }
  return value;
}

}  // namespace

void TimedValue::set(Json& tree, double t) const {
  const auto next = size_t(std::upper_bound(time_s.begin(), time_s.end(), t) - time_s.begin());
  const auto component = [&](const std::vector<double>& value) {
    if (next == 0) return value.front();
    if (next == time_s.size()) return value.back();
    return between_keys(time_s, value, next - 1, t, between);
  };
  Json& into = tree.at(at);
  if (!is_list)
    into = component(components[0]);
  else
    for (size_t c = 0; c < components.size(); ++c) into[c] = component(components[c]);
}

Expected<void> take_timed_values(Json& j, const std::string& place, const Json::json_pointer& at,
                                 std::vector<TimedValue>& values) {
  if (j.is_array() && !j.empty() && j[0].is_object())
    for (size_t i = 0; i < j.size(); ++i)
      if (auto done = take_timed_values(j[i], fmt::format("{}/{}", place, i), at / i, values); !done) return done;
  if (!j.is_object()) return {};
  if (!j.contains("keys")) {
    for (auto& [key, value] : j.items())
      if (auto done = take_timed_values(value, place + "/" + key, at / key, values); !done) return done;
    return {};
  }
  const std::vector<std::string> names = {"keys", "interpolation"};
  for (const auto& [key, value] : j.items())
    if (std::find(names.begin(), names.end(), key) == names.end())
      return wrong(place + "/" + key, unknown_name("key", key, names));
  const auto between = read_interpolation(j, place);
  if (!between) return std::unexpected(between.error());
  const Json keys = std::move(j["keys"]);
  const auto numbers = check_keys(keys, place + "/keys");
  if (!numbers) return std::unexpected(numbers.error());
  values.push_back(timed_value(keys, *numbers, *between, at));
  j = keys[0][1];
  return {};
}

}  // namespace candela::look_rows
