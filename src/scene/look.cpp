#include "scene/look.h"

#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "base/files.h"
#include "base/text.h"

namespace candela {
namespace {

using Json = nlohmann::ordered_json;

std::unexpected<Error> wrong(const std::string& place, const std::string& what) {
  return std::unexpected(Error{ErrorKind::input, what, place});
}

template <class T>
using Readers = std::map<std::string, std::function<Expected<void>(const Json&, const std::string& place, T&)>>;

template <class T>
Expected<void> read_keys(const Json& j, const std::string& place, const Readers<T>& readers, T& into) {
  if (!j.is_object()) return wrong(place, "the value is not an object");
  std::vector<std::string> names;
  for (const auto& [name, reader] : readers) names.push_back(name);
  for (const auto& [key, value] : j.items()) {
    const std::string at = place + "/" + key;
    const auto reader = readers.find(key);
    if (reader == readers.end()) return wrong(at, unknown_name("key", key, names));
    if (auto read = reader->second(value, at, into); !read) return read;
  }
  return {};
}

Expected<double> number(const Json& j, const std::string& place) {
  if (!j.is_number()) return wrong(place, "the value is not a number");
  const double value = j.get<double>();
  if (!std::isfinite(float(value))) return wrong(place, fmt::format("{} is beyond what a 32-bit number holds", value));
  return value;
}

Expected<double> from_zero(const Json& j, const std::string& place) {
  const auto value = number(j, place);
  if (value && !(*value >= 0)) return wrong(place, fmt::format("{} is below 0", *value));
  return value;
}

// One number for all channels, or three.
Expected<glm::dvec3> colour(const Json& j, const std::string& place) {
  if (!j.is_array()) {
    const auto value = from_zero(j, place);
    return value ? Expected<glm::dvec3>(glm::dvec3(*value)) : std::unexpected(value.error());
  }
  if (j.size() != 3)
    return wrong(place, fmt::format("the list holds {} values; write one number or three: red, green, blue", j.size()));
  glm::dvec3 out;
  for (int c = 0; c < 3; ++c) {
    const auto value = from_zero(j[size_t(c)], fmt::format("{}/{}", place, c));
    if (!value) return std::unexpected(value.error());
    out[c] = *value;
  }
  return out;
}

// The keys of "fog" as they stand in the file; two ways to say what the air does exclude each other.
struct FogKeys {
  Fog fog;
  std::optional<glm::dvec3> extinction, albedo, scattering, absorption;
};

template <class Value, class Parse>
auto into(Value member, Parse parse) {
  return [=](const Json& j, const std::string& place, FogKeys& keys) -> Expected<void> {
    const auto value = parse(j, place);
    if (!value) return std::unexpected(value.error());
    std::invoke(member, keys) = *value;
    return {};
  };
}

Expected<double> anisotropy(const Json& j, const std::string& place) {
  const auto g = number(j, place);
  if (g && std::abs(*g) > largest_anisotropy)
    return wrong(place, fmt::format("{} is outside -{} to {}", *g, largest_anisotropy, largest_anisotropy));
  return g;
}

Expected<glm::dvec3> albedo(const Json& j, const std::string& place) {
  const auto value = colour(j, place);
  if (value && glm::any(glm::greaterThan(*value, glm::dvec3(1))))
    return wrong(place, "an albedo is at most 1: air scatters no more than it meets");
  return value;
}

Expected<void> bounds(const Json& j, const std::string& place, FogKeys& keys) {
  Readers<FogKeys> axes;
  for (int axis = 0; axis < 3; ++axis)
    axes[std::string(1, char('x' + axis))] = [axis](const Json& v, const std::string& at,
                                                    FogKeys& into) -> Expected<void> {
      if (!v.is_array() || v.size() != 2)
        return wrong(at, "the value is not a list of two numbers, lowest and highest");
      const auto low = number(v[0], at + "/0"), high = number(v[1], at + "/1");
      if (!low) return std::unexpected(low.error());
      if (!high) return std::unexpected(high.error());
      if (!(*low < *high)) return wrong(at, fmt::format("{} is not below {}", *low, *high));
      into.fog.lowest[axis] = *low, into.fog.highest[axis] = *high;
      return {};
    };
  return read_keys(j, place, axes, keys);
}

const Readers<FogKeys>& fog_readers() {
  static const Readers<FogKeys> table = {
      {"extinction", into(&FogKeys::extinction, colour)},
      {"albedo", into(&FogKeys::albedo, albedo)},
      {"scattering", into(&FogKeys::scattering, colour)},
      {"absorption", into(&FogKeys::absorption, colour)},
      {"anisotropy", into([](FogKeys& k) -> double& { return k.fog.anisotropy; }, anisotropy)},
      {"emission", into([](FogKeys& k) -> glm::dvec3& { return k.fog.emission_per_m; }, colour)},
      {"falloff", into([](FogKeys& k) -> double& { return k.fog.falloff_per_m; }, from_zero)},
      {"height", into([](FogKeys& k) -> double& { return k.fog.height_m; }, number)},
      {"bounds", bounds},
  };
  return table;
}

Expected<void> read_fog(const Json& j, const std::string& place, Look& look) {
  FogKeys keys;
  if (auto read = read_keys(j, place, fog_readers(), keys); !read) return read;
  Fog& fog = keys.fog;
  const bool by_parts = keys.scattering || keys.absorption;
  if (by_parts && (keys.extinction || keys.albedo))
    return wrong(place, "extinction and albedo say the same as scattering and absorption; write one pair");
  if (!by_parts && !keys.extinction) return wrong(place, "lacks extinction (per metre), or scattering and absorption");
  if (by_parts) {
    fog.scattering_per_m = keys.scattering.value_or(glm::dvec3(0));
    fog.extinction_per_m = fog.scattering_per_m + keys.absorption.value_or(glm::dvec3(0));
  } else {
    fog.extinction_per_m = *keys.extinction;
    fog.scattering_per_m = *keys.extinction * keys.albedo.value_or(glm::dvec3(1));
  }
  for (int c = 0; c < 3; ++c) {
    if (!std::isfinite(float(fog.extinction_per_m[c])))
      return wrong(place, "scattering and absorption together are beyond what a 32-bit number holds");
    // What glows without end and is not weakened would be infinitely bright towards every horizon.
    if (fog.emission_per_m[c] > 0 && !std::isfinite(float(fog.emission_per_m[c] / fog.extinction_per_m[c])))
      return wrong(place + "/emission", "needs extinction above 0 in the same channel");
  }
  look.fog = fog;
  return {};
}

Expected<void> read_sun(const Json& j, const std::string& place, Look& look) {
  const Readers<Sun> readers = {
      {"angular_radius_deg", [](const Json& value, const std::string& at, Sun& sun) -> Expected<void> {
         const auto degrees = from_zero(value, at);
         if (!degrees) return std::unexpected(degrees.error());
         if (*degrees > largest_sun_radius_deg)
           return wrong(at, fmt::format("{} is above {} degrees", *degrees, largest_sun_radius_deg));
         sun.angular_radius_deg = *degrees;
         return {};
       }}};
  Sun sun;
  if (auto read = read_keys(j, place, readers, sun); !read) return read;
  look.sun = sun;
  return {};
}

// A parser that takes the last of two equal keys would leave a value out in silence.
Expected<Json> parse_strictly(const std::string& text, const std::string& place) {
  std::vector<std::set<std::string>> open;
  std::string repeated;
  const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key && !open.back().insert(parsed.get<std::string>()).second && repeated.empty())
      repeated = parsed.get<std::string>();
    return true;
  };
  try {
    Json j = Json::parse(text, watch);
    if (!repeated.empty()) return wrong(place, fmt::format("the key '{}' stands twice in one object", repeated));
    return j;
  } catch (const Json::exception& e) {
    return wrong(place, fmt::format("is no JSON: {}", e.what()));
  }
}

}  // namespace

Expected<Look> look_from_json(const std::string& text, const std::string& place) {
  const auto j = parse_strictly(text, place);
  if (!j) return std::unexpected(j.error());
  if (!j->is_object()) return wrong(place, "a look is a JSON object");
  Look look;
  const Readers<Look> readers = {{"fog", read_fog}, {"sun", read_sun}};
  if (auto read = read_keys(*j, place + ": ", readers, look); !read) return std::unexpected(read.error());
  return look;
}

Expected<Look> read_look(const std::filesystem::path& file) {
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  return look_from_json(std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()), file.string());
}

}  // namespace candela
