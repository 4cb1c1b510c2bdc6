// Values over time.
#include "scene/look_rows.h"

namespace candela::look_rows {
namespace {

enum class Between : uint8_t { linear, step, cubic };

// Checks the keys of one value; returns how many numbers each has, 0 for a plain number.
Expected<size_t> check_keys(const Json& keys, const std::string& place) {
  if (!keys.is_array() || keys.empty()) return wrong(place, "the value is not a list of [time, value]");
  double before = -std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < keys.size(); ++i) {
    const std::string at = fmt::format("{}/{}", place, i);
    const Json& key = keys[i];
    if (!key.is_array() || key.size() != 2) return wrong(at, "the value is not [time, value]");
    const auto time = number(key[0], at + "/0");
    if (!time) return std::unexpected(time.error());
    if (!(*time > before)) return wrong(at + "/0", "the times do not ascend");
    before = *time;
    const bool list = key[1].is_array();
    if (list != keys[0][1].is_array() || (list && key[1].size() != keys[0][1].size()))
      return wrong(at + "/1", "the value is of another kind than the first key's");
    for (size_t c = 0; c < (list ? key[1].size() : 1); ++c)
      if (const auto value = number(list ? key[1][c] : key[1], at + "/1"); !value)
        return std::unexpected(value.error());
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

// One component of the keys.
struct Curve {
  std::vector<double> time, value;
  double slope(size_t i) const { return (value[i + 1] - value[i]) / (time[i + 1] - time[i]); }
  // Fritsch and Butland, "A Method for Constructing Local Monotone Piecewise Cubic Interpolants", 1984: 0 at a turning
  // point, the weighted harmonic mean of both sides' slopes elsewhere.
  double tangent(size_t i) const {
    if (i == 0) return slope(0);
    if (i + 1 == time.size()) return slope(i - 1);
    const double before = slope(i - 1), after = slope(i);
    if (!(before * after > 0)) return 0;
    const double h0 = time[i] - time[i - 1], h1 = time[i + 1] - time[i];
    return 3 * (h0 + h1) / ((2 * h1 + h0) / before + (h1 + 2 * h0) / after);
  }
  double at(size_t i, double time_s, Between between) const {
    const double a = value[i], b = value[i + 1], h = time[i + 1] - time[i], s = (time_s - time[i]) / h;
    if (between == Between::step) return a;
    if (between == Between::linear) return (1 - s) * a + s * b;
    const double s2 = s * s, s3 = s2 * s;
    const double v = (2 * s3 - 3 * s2 + 1) * a + (s3 - 2 * s2 + s) * h * tangent(i) + (3 * s2 - 2 * s3) * b +
                     (s3 - s2) * h * tangent(i + 1);
    return std::clamp(v, std::min(a, b), std::max(a, b));  // rounding alone
  }
};

Json value_at(const Json& keys, size_t numbers, double time_s, Between between) {
  size_t next = 0;
  while (next < keys.size() && keys[next][0].get<double>() <= time_s) ++next;
  if (next == 0) return keys[0][1];
  if (next == keys.size()) return keys[next - 1][1];
  const auto component = [&](size_t c) {
    Curve curve;
    for (const Json& key : keys) {
      curve.time.push_back(key[0].get<double>());
      curve.value.push_back(numbers > 0 ? key[1][c].get<double>() : key[1].get<double>());
    }
    return curve.at(next - 1, time_s, between);
  };
  if (numbers == 0) return Json(component(0));
  Json list = Json::array();
  for (size_t c = 0; c < numbers; ++c) list.push_back(component(c));
  return list;
}

}  // namespace

Expected<void> evaluate(Json& j, const std::string& place, double time_s, std::vector<double>* times) {
  if (j.is_array() && !j.empty() && j[0].is_object())
    for (size_t i = 0; i < j.size(); ++i)
      if (auto done = evaluate(j[i], fmt::format("{}/{}", place, i), time_s, times); !done) return done;
  if (!j.is_object()) return {};
  if (!j.contains("keys")) {
    for (auto& [key, value] : j.items())
      if (auto done = evaluate(value, place + "/" + key, time_s, times); !done) return done;
    return {};
  }
  const std::vector<std::string> names = {"keys", "interpolation"};
  for (const auto& [key, value] : j.items())
    if (std::find(names.begin(), names.end(), key) == names.end())
      return wrong(place + "/" + key, unknown_name("key", key, names));
  const auto between = read_interpolation(j, place);
  if (!between) return std::unexpected(between.error());
  const Json keys = j["keys"];
  const auto numbers = check_keys(keys, place + "/keys");
  if (!numbers) return std::unexpected(numbers.error());
  if (times)
    for (const Json& key : keys) times->push_back(key[0].get<double>());
  j = value_at(keys, *numbers, time_s, *between);
  return {};
}

}  // namespace candela::look_rows
