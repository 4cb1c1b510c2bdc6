#include "scene/look.h"

#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include "base/files.h"
#include "base/json.h"
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

Expected<void> read_sky_look(const Json& j, const std::string& place, Look& look) {
  const Readers<SkyLook> readers = {
      {"rotation_deg",
       [](const Json& value, const std::string& at, SkyLook& sky) -> Expected<void> {
         const auto degrees = number(value, at);
         if (!degrees) return std::unexpected(degrees.error());
         sky.rotation_deg = *degrees;
         return {};
       }},
      {"intensity", [](const Json& value, const std::string& at, SkyLook& sky) -> Expected<void> {
         const auto times = from_zero(value, at);
         if (!times) return std::unexpected(times.error());
         sky.intensity = *times;
         return {};
       }}};
  return read_keys(j, place, readers, look.sky);
}

Expected<double> from_zero_to(const Json& j, const std::string& place, double most) {
  const auto value = from_zero(j, place);
  if (value && *value > most) return wrong(place, fmt::format("{} is above {}", *value, most));
  return value;
}

Expected<void> read_occlusion(const Json& j, const std::string& place, Look& look) {
  const auto into_number = [](double Occlusion::*member, double most) {
    return [=](const Json& v, const std::string& at, Occlusion& o) -> Expected<void> {
      const auto value = from_zero_to(v, at, most);
      if (!value) return std::unexpected(value.error());
      o.*member = *value;
      return {};
    };
  };
  const Readers<Occlusion> readers = {
      {"radius_m",
       [](const Json& v, const std::string& at, Occlusion& o) -> Expected<void> {
         const auto value = from_zero(v, at);
         if (!value) return std::unexpected(value.error());
         if (!(*value > 0)) return wrong(at, "the value is not above 0; \"strength\": 0 switches occlusion off");
         o.radius_m = *value;
         return {};
       }},
      {"falloff", into_number(&Occlusion::falloff, 1)},
      {"strength", into_number(&Occlusion::strength, 1)},
  };
  Occlusion occlusion;
  if (auto read = read_keys(j, place, readers, occlusion); !read) return read;
  look.occlusion = occlusion;
  return {};
}

Expected<void> read_shadows(const Json& j, const std::string& place, Look& look) {
  const Readers<ShadowLook> readers = {
      {"lights", [](const Json& v, const std::string& at, ShadowLook& s) -> Expected<void> {
         if (!v.is_array()) return wrong(at, "the value is not a list of names of nodes");
         for (size_t i = 0; i < v.size(); ++i) {
           if (!v[i].is_string()) return wrong(fmt::format("{}/{}", at, i), "the value is not a node's name");
           s.lights.push_back(v[i].get<std::string>());
         }
         return {};
       }}};
  return read_keys(j, place, readers, look.shadows);
}

// "preset" comes first, whatever the order of the keys: the others go over it.
Expected<void> read_bloom(const Json& j, const std::string& place, Look& look) {
  constexpr double no_limit = std::numeric_limits<double>::infinity();
  constexpr size_t most_levels = 12;
  Bloom bloom;
  if (j.is_object() && j.contains("preset")) {
    if (j["preset"] != "city-lights") return wrong(place + "/preset", "the only preset is city-lights");
    bloom = {.strength = 1, .threshold = 1.5, .knee = 0.25, .weights = {1, 0.5, 0.25, 0.125, 0.0625}, .keeps = false};
  }
  const auto into_number = [](double Bloom::*member, double most) {
    return [=](const Json& v, const std::string& at, Bloom& b) -> Expected<void> {
      const auto value = from_zero_to(v, at, most);
      if (!value) return std::unexpected(value.error());
      b.*member = *value;
      return {};
    };
  };
  const auto into_flag = [](bool Bloom::*member) {
    return [=](const Json& v, const std::string& at, Bloom& b) -> Expected<void> {
      if (!v.is_boolean()) return wrong(at, "the value is neither true nor false");
      b.*member = v.get<bool>();
      return {};
    };
  };
  const Readers<Bloom> readers = {
      {"preset", [](const Json&, const std::string&, Bloom&) -> Expected<void> { return {}; }},
      {"strength", into_number(&Bloom::strength, no_limit)},
      {"threshold", into_number(&Bloom::threshold, no_limit)},
      {"knee", into_number(&Bloom::knee, no_limit)},
      {"keeps", into_flag(&Bloom::keeps)},
      {"beauty", into_flag(&Bloom::in_beauty)},
      {"weights",
       [=](const Json& v, const std::string& at, Bloom& b) -> Expected<void> {
         if (!v.is_array() || v.empty() || v.size() > most_levels)
           return wrong(at, fmt::format("the value is not a list of 1 to {} weights", most_levels));
         b.weights.clear();
         double sum = 0;
         for (size_t i = 0; i < v.size(); ++i) {
           const auto weight = from_zero(v[i], fmt::format("{}/{}", at, i));
           if (!weight) return std::unexpected(weight.error());
           b.weights.push_back(*weight);
           sum += *weight;
         }
         if (!(sum > 0)) return wrong(at, "the weights are all 0");
         return {};
       }},
  };
  if (auto read = read_keys(j, place, readers, bloom); !read) return read;
  if (bloom.keeps && bloom.strength > 1)
    return wrong(place + "/strength", fmt::format("{} is above 1: no more light can be scattered than there is; "
                                                  "\"keeps\": false adds it",
                                                  bloom.strength));
  look.bloom = bloom;
  return {};
}

// The value of {"keys": [[t, v], ...]} at a time; numbers, or lists of as many numbers.
Expected<Json> value_at(const Json& keys, const std::string& place, double time_s) {
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
  size_t next = 0;
  while (next < keys.size() && keys[next][0].get<double>() <= time_s) ++next;
  if (next == 0) return keys[0][1];
  if (next == keys.size()) return keys[next - 1][1];
  const double t0 = keys[next - 1][0].get<double>(), t1 = keys[next][0].get<double>();
  const double s = (time_s - t0) / (t1 - t0);
  const auto between = [&](const Json& a, const Json& b) { return (1 - s) * a.get<double>() + s * b.get<double>(); };
  if (!keys[0][1].is_array()) return Json(between(keys[next - 1][1], keys[next][1]));
  Json list = Json::array();
  for (size_t c = 0; c < keys[0][1].size(); ++c) list.push_back(between(keys[next - 1][1][c], keys[next][1][c]));
  return list;
}

Expected<void> evaluate(Json& j, const std::string& place, double time_s) {
  if (j.is_object() && j.size() == 1 && j.contains("keys")) {
    auto value = value_at(j["keys"], place + "/keys", time_s);
    if (!value) return std::unexpected(value.error());
    j = Json(std::move(*value));
    return {};
  }
  if (!j.is_object()) return {};
  for (auto& [key, value] : j.items())
    if (auto done = evaluate(value, place + "/" + key, time_s); !done) return done;
  return {};
}

}  // namespace

Expected<Look> look_from_json(const std::string& text, const std::string& place, double time_s) {
  auto j = read_json(text, place);
  if (!j) return std::unexpected(j.error());
  if (!j->is_object()) return wrong(place, "a look is a JSON object");
  if (auto evaluated = evaluate(*j, place + ": ", time_s); !evaluated) return std::unexpected(evaluated.error());
  Look look;
  const Readers<Look> readers = {{"fog", read_fog},
                                 {"sun", read_sun},
                                 {"sky", read_sky_look},
                                 {"bloom", read_bloom},
                                 {"occlusion", read_occlusion},
                                 {"shadows", read_shadows}};
  if (auto read = read_keys(*j, place + ": ", readers, look); !read) return std::unexpected(read.error());
  return look;
}

Expected<LookFile> read_look_file(const std::filesystem::path& file) {
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  return LookFile{std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()), file.string()};
}

Expected<Look> read_look(const std::filesystem::path& file, double time_s) {
  const auto read = read_look_file(file);
  if (!read) return std::unexpected(read.error());
  return look_from_json(read->text, read->place, time_s);
}

}  // namespace candela
