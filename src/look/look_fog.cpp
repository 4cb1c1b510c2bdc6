// The keys of "fog" in a look file.
#include "look/look_rows.h"

namespace candela::look_rows {
namespace {

// The keys of "fog" as they stand in the file; two ways to say what the air does exclude each other.
struct FogKeys {
  Fog fog;
  std::optional<glm::dvec3> extinction, albedo, scattering, absorption;
  std::vector<Fog> boxes;
};

Row<FogKeys> axis_row(int axis) {
  LookKey key = key_of(std::string(1, char('x' + axis)), LookKey::Kind::numbers, {}, "metres: lowest and highest");
  key.least = key.most = 2;
  return {key, [axis](const Json& v, const std::string& at, FogKeys& into) -> Expected<void> {
            if (!v.is_array() || v.size() != 2)
              return wrong(at, "the value is not a list of two numbers, lowest and highest");
            const auto low = number(v[0], at + "/0"), high = number(v[1], at + "/1");
            if (!low) return std::unexpected(low.error());
            if (!high) return std::unexpected(high.error());
            if (!(*low < *high)) return wrong(at, fmt::format("{} is not below {}", *low, *high));
            into.fog.lowest[axis] = *low, into.fog.highest[axis] = *high;
            return {};
          }};
}

// Checks them as a whole.
Expected<Fog> fog_of(const std::string& place, const FogKeys& keys) {
  Fog fog = keys.fog;
  const bool by_parts = keys.scattering || keys.absorption;
  if (by_parts && (keys.extinction || keys.albedo))
    return wrong(place, "extinction and albedo say the same as scattering and absorption; write one pair");
  if (!by_parts && !keys.extinction) return wrong(place, "lacks extinction (per metre), or scattering and absorption");
  if (keys.albedo && glm::any(glm::greaterThan(*keys.albedo, glm::dvec3(1))))
    return wrong(place + "/albedo", "an albedo is at most 1: air scatters no more than it meets");
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
  for (const int axis : {0, 2})
    if (fog.turn_rad != 0 && (std::isinf(fog.lowest[axis]) || std::isinf(fog.highest[axis])))
      return wrong(place + "/rotation_deg", "needs bounds of x and z, about whose middle it turns");
  return fog;
}

// The first medium is the look's fog, whether it stands for itself or is a box.
Expected<void> set_fog(const Json& j, const std::string& place, FogKeys& keys, Look& look) {
  look.more_fog = std::move(keys.boxes);
  if (j.contains("boxes") && j.size() == 1) {
    if (look.more_fog.empty()) return wrong(place, "lacks extinction (per metre), or boxes that have one");
    look.fog = look.more_fog.front();
    look.more_fog.erase(look.more_fog.begin());
    return {};
  }
  auto fog = fog_of(place, keys);
  if (!fog) return std::unexpected(fog.error());
  look.fog = *fog;
  return {};
}

Rows<FogKeys> fog_rows() {
  const auto copy = [](FogKeys& k) { return k; };
  const auto keep = [](const Json&, const std::string&, FogKeys& part, FogKeys& into) -> Expected<void> {
    into = part;
    return {};
  };
  Row<FogKeys> albedo = color_row<FogKeys>("albedo", from_zero(), &FogKeys::albedo,
                                           "the part of the extinction that is scattered; 1 by default");
  albedo.key.high = 1;  // set_fog() says why
  return {
      color_row<FogKeys>("extinction", from_zero(), &FogKeys::extinction,
                         "per metre: light that a metre takes out of a ray at density 1"),
      albedo,
      color_row<FogKeys>("scattering", from_zero(), &FogKeys::scattering, "per metre; instead of extinction"),
      color_row<FogKeys>("absorption", from_zero(), &FogKeys::absorption, "per metre; instead of extinction"),
      number_row<FogKeys>(
          "anisotropy", between(-largest_anisotropy, largest_anisotropy),
          [](FogKeys& k) -> double& { return k.fog.anisotropy; }, "g of Henyey and Greenstein's phase function"),
      color_row<FogKeys>(
          "emission", from_zero(), [](FogKeys& k) -> glm::dvec3& { return k.fog.emission_per_m; },
          "cd/m2 per metre that the air gives by itself"),
      number_row<FogKeys>(
          "falloff", from_zero(), [](FogKeys& k) -> double& { return k.fog.falloff_per_m; },
          "per metre: the density is exp(-falloff (y - height))"),
      number_row<FogKeys>(
          "height", {}, [](FogKeys& k) -> double& { return k.fog.height_m; }, "metres: where the density is 1"),
      object_row<FogKeys, FogKeys>("bounds", {axis_row(0), axis_row(1), axis_row(2)}, copy, keep,
                                   "outside there is no fog"),
      Row<FogKeys>{key_of("rotation_deg", LookKey::Kind::number, {},
                          "degrees: of the bounds about +Y through their middle, counter-clockwise seen from above"),
                   [](const Json& v, const std::string& at, FogKeys& into) -> Expected<void> {
                     const auto degrees = number(v, at);
                     if (!degrees) return std::unexpected(degrees.error());
                     into.fog.turn_rad = glm::radians(*degrees);
                     return {};
                   }},
  };
}

}  // namespace

Row<Look> fog_row() {
  Rows<FogKeys> rows = fog_rows();
  rows.push_back(objects_row<FogKeys, FogKeys>(
      "boxes", most_fog_boxes, fog_rows(),
      [](const Json&, const std::string& place, FogKeys& box, FogKeys& into) -> Expected<void> {
        auto fog = fog_of(place, box);
        if (!fog) return std::unexpected(fog.error());
        into.boxes.push_back(*fog);
        return {};
      },
      "further media, each with keys as fog has them; where media overlap the air is their sum"));
  return object_row<Look, FogKeys>(
      "fog", rows, [](Look&) { return FogKeys{}; }, set_fog, "air that absorbs, scatters and glows");
}

Row<Look> volumetric_row() {
  struct Keys {
    Volumetric light;
    std::string formula;
  };
  return object_row<Look, Keys>(
      "volumetric",
      {number_row<Keys>(
           "phi", from_zero(), [](Keys& k) -> double& { return k.light.phi; }, "times local lights' light in the air"),
       number_row<Keys>(
           "tau", from_zero(), [](Keys& k) -> double& { return k.light.tau_per_m; },
           "per metre: what the air takes on the way from local light to camera"),
       number_row<Keys>(
           "anisotropy", between(-largest_anisotropy, largest_anisotropy),
           [](Keys& k) -> double& { return k.light.anisotropy; }, "g of Henyey and Greenstein's phase function"),
       text_row<Keys>("formula", {"extinction", "attenuation"}, &Keys::formula,
                      "a metre of air scatters tau of the light, or the light's own attenuation over its range")},
      [](Look&) { return Keys{}; },
      [](const Json&, const std::string&, Keys& keys, Look& look) -> Expected<void> {
        look.volumetric = keys.light;
        look.volumetric->by_attenuation = keys.formula == "attenuation";
        return {};
      },
      "light of point and spot lights in the air, over the picture");
}

}  // namespace candela::look_rows
