#include "look/look.h"

#include "look/look_rows.h"

namespace candela {
namespace look_rows {

Expected<double> number(const Json& j, const std::string& place, Range range) {
  if (!j.is_number()) return wrong(place, "the value is not a number");
  const double value = j.get<double>();
  if (!std::isfinite(float(value))) return wrong(place, fmt::format("{} is beyond what a 32-bit number holds", value));
  const bool both = range.low != 0 && std::isfinite(range.low) && std::isfinite(range.high);
  if (both && !(value >= range.low && value <= range.high))
    return wrong(place, fmt::format("{} is outside {} to {}", value, range.low, range.high));
  if (!(value >= range.low)) return wrong(place, fmt::format("{} is below {}", value, range.low));
  if (range.above_low && !(value > range.low)) return wrong(place, fmt::format("{} is not above {}", value, range.low));
  if (!(value <= range.high)) return wrong(place, fmt::format("{} is above {}", value, range.high));
  return value;
}

Expected<glm::dvec3> color(const Json& j, const std::string& place, Range range) {
  if (!j.is_array()) {
    const auto value = number(j, place, range);
    return value ? Expected<glm::dvec3>(glm::dvec3(*value)) : std::unexpected(value.error());
  }
  if (j.size() != 3)
    return wrong(place, fmt::format("the list holds {} values; write one number or three: red, green, blue", j.size()));
  glm::dvec3 out;
  for (int c = 0; c < 3; ++c) {
    const auto value = number(j[size_t(c)], fmt::format("{}/{}", place, c), range);
    if (!value) return std::unexpected(value.error());
    out[c] = *value;
  }
  return out;
}

}  // namespace look_rows

namespace {

using namespace look_rows;

Row<Look> sun_row() {
  return object_row<Look, Sun>(
      "sun",
      {number_row<Sun>("angular_radius_deg", between(0, largest_sun_radius_deg), &Sun::angular_radius_deg,
                       "degrees: the radius of directional lights as they are seen; 0 is a point")},
      [](Look&) { return Sun{}; },
      [](const Json&, const std::string&, Sun& sun, Look& look) -> Expected<void> {
        look.sun = sun;
        return {};
      },
      "the directional lights' disc in the sky");
}

Row<Look> lights_row() {
  return object_row<Look, LampLook>(
      "lights",
      {number_row<LampLook>("radius_m", from_zero(), &LampLook::radius_m,
                            "metres: of point and spot lights that have no CANDELA_light_size; 0 is a point")},
      [](Look&) { return LampLook{}; },
      [](const Json&, const std::string&, LampLook& lights, Look& look) -> Expected<void> {
        look.lights = lights;
        return {};
      },
      "the size of point and spot lights");
}

Row<Look> occlusion_row() {
  return object_row<Look, Occlusion>(
      "occlusion",
      {number_row<Occlusion>("radius_m", above_zero(), &Occlusion::radius_m,
                             "metres: what is farther off does not hide the sky"),
       number_row<Occlusion>("falloff", between(0, 1), &Occlusion::falloff,
                             "the part of the radius over which the effect fades"),
       number_row<Occlusion>("strength", between(0, 1), &Occlusion::strength, "of the darkening")},
      [](Look&) { return Occlusion{}; },
      [](const Json&, const std::string&, Occlusion& occlusion, Look& look) -> Expected<void> {
        look.occlusion = occlusion;
        return {};
      },
      "how surfaces near a point hide the sky from it");
}

// An empty object, or one with nothing but "scene": whether they are there.
struct ReflectionKeys {
  bool scene = true;
};
Row<Look> reflections_row() {
  return object_row<Look, ReflectionKeys>(
      "reflections",
      {flag_row<ReflectionKeys>("scene", &ReflectionKeys::scene,
                                "whether surfaces reflect each other; true where it is not said")},
      [](Look&) { return ReflectionKeys{}; },
      [](const Json&, const std::string&, ReflectionKeys& keys, Look& look) -> Expected<void> {
        if (keys.scene) look.reflections = ReflectionLook{};
        return {};
      },
      "what surfaces reflect beside the sky");
}

Row<Bloom> weights_row() {
  static constexpr size_t most_levels = 12;
  LookKey key = key_of("weights", LookKey::Kind::numbers, from_zero(), "of the levels, finest first");
  key.least = 1, key.most = most_levels;
  return {key, [](const Json& v, const std::string& at, Bloom& b) -> Expected<void> {
            if (!v.is_array() || v.empty() || v.size() > most_levels)
              return wrong(at, fmt::format("the value is not a list of 1 to {} weights", most_levels));
            b.weights.clear();
            double sum = 0;
            for (size_t i = 0; i < v.size(); ++i) {
              const auto weight = number(v[i], fmt::format("{}/{}", at, i), from_zero());
              if (!weight) return std::unexpected(weight.error());
              b.weights.push_back(*weight);
              sum += *weight;
            }
            if (!(sum > 0)) return wrong(at, "the weights are all 0");
            return {};
          }};
}

// "preset" comes first, whatever the order of the keys: the others go over it.
Row<Look> bloom_row() {
  LookKey preset = key_of("preset", LookKey::Kind::text, {}, "values that the other keys go over");
  preset.choices = {"city-lights"};
  const Rows<Bloom> rows = {
      {preset, [](const Json&, const std::string&, Bloom&) -> Expected<void> { return {}; }},
      number_row<Bloom>("strength", from_zero(), &Bloom::strength, "the fraction of the light that is scattered"),
      number_row<Bloom>("threshold", from_zero(), &Bloom::threshold, "exposed radiance: less does not glow"),
      number_row<Bloom>("knee", from_zero(), &Bloom::knee, "half the width over which the threshold sets in"),
      flag_row<Bloom>("keeps", &Bloom::keeps, "what is scattered is taken from where it came; otherwise it is added"),
      flag_row<Bloom>("beauty", &Bloom::in_beauty, "in linear output too"),
      flag_row<Bloom>("emission", &Bloom::of_emission, "what surfaces emit glows alone, not what is lit or behind"),
      weights_row(),
  };
  const auto done = [rows](const Json& j, const std::string& place, Bloom& bloom, Look& look) -> Expected<void> {
    if (j.contains("preset")) {
      if (j["preset"] != "city-lights") return wrong(place + "/preset", "the only preset is city-lights");
      bloom = {.strength = 1, .threshold = 1.5, .knee = 0.25, .weights = {1, 0.5, 0.25, 0.125, 0.0625}, .keeps = false};
      if (auto again = read_rows(j, place, rows, bloom); !again) return again;
    }
    if (bloom.keeps && bloom.strength > 1)
      return wrong(place + "/strength", fmt::format("{} is above 1: no more light can be scattered than there is; "
                                                    "\"keeps\": false adds it",
                                                    bloom.strength));
    look.bloom = bloom;
    return {};
  };
  return object_row<Look, Bloom>(
      "bloom", rows, [](Look&) { return Bloom{}; }, done, "light that lens and eye scatter round bright things");
}

Row<SkyLook> gradient_row() {
  return object_row<SkyLook, SkyGradient>(
      "gradient",
      {color_row<SkyGradient>("zenith", from_zero(), &SkyGradient::zenith, "radiance straight up"),
       color_row<SkyGradient>("horizon", from_zero(), &SkyGradient::horizon, "radiance at the horizon"),
       color_row<SkyGradient>("ground", from_zero(), &SkyGradient::ground, "radiance straight down"),
       number_row<SkyGradient>("exponent", between(0.05, 20), &SkyGradient::exponent,
                               "of the sine of the elevation, by which zenith and ground set in")},
      [](SkyLook&) { return SkyGradient{}; },
      [](const Json&, const std::string&, SkyGradient& gradient, SkyLook& sky) -> Expected<void> {
        sky.gradient = gradient;
        return {};
      },
      "a sky of three colours, without an image");
}

Row<SkyLook> atmosphere_row() {
  return object_row<SkyLook, Atmosphere>(
      "atmosphere",
      {number_row<Atmosphere>("haze", between(0, 100), &Atmosphere::haze, "times the Earth's aerosols"),
       number_row<Atmosphere>("ozone", between(0, 100), &Atmosphere::ozone, "times the Earth's ozone"),
       number_row<Atmosphere>("ground_albedo", between(0, 1), &Atmosphere::ground_albedo,
                              "of the ground below the horizon"),
       number_row<Atmosphere>("altitude_m", between(0, 50'000), &Atmosphere::altitude_m, "metres: of the observer"),
       color_row<Atmosphere>("sun_lux", from_zero(), &Atmosphere::sun_lux,
                             "of the sun above the air; without it that of the first directional light")},
      [](SkyLook&) { return Atmosphere{}; },
      [](const Json&, const std::string&, Atmosphere& air, SkyLook& sky) -> Expected<void> {
        sky.atmosphere = air;
        return {};
      },
      "the day sky of the Earth's air under the scene's first directional light");
}

Row<SkyLook> second_row() {
  struct Keys {
    SecondSky sky;
    std::optional<double> weight;
    bool has_image = false;
  };
  const Rows<SecondSky> follows = {
      number_row<SecondSky>("from_deg", between(-90, 90), &SecondSky::from_deg, "elevation at which the weight is 1"),
      number_row<SecondSky>("to_deg", between(-90, 90), &SecondSky::to_deg, "elevation at which the weight is 0")};
  const Rows<Keys> rows = {
      text_row<Keys>(
          "image", {}, [](Keys& k) -> std::string& { return k.sky.image; },
          "as --sky takes it, from the look's folder"),
      number_row<Keys>(
          "intensity", from_zero(), [](Keys& k) -> double& { return k.sky.intensity; }, "times this image's radiance"),
      number_row<Keys>("weight", between(0, 1), &Keys::weight, "0: the first sky alone; 1: this one alone"),
      object_row<Keys, SecondSky>(
          "follows_sun", follows, [](Keys& k) { return k.sky; },
          [](const Json&, const std::string& at, SecondSky& sky, Keys& keys) -> Expected<void> {
            if (!(sky.from_deg < sky.to_deg))
              return wrong(at, fmt::format("from_deg {} is not below to_deg {}", sky.from_deg, sky.to_deg));
            keys.sky.from_deg = sky.from_deg, keys.sky.to_deg = sky.to_deg, keys.sky.follows_sun = true;
            return {};
          },
          "instead of weight: 1 - smoothstep(from, to, the first directional light's elevation)"),
  };
  return object_row<SkyLook, Keys>(
      "second", rows, [](SkyLook&) { return Keys{}; },
      [](const Json&, const std::string& place, Keys& keys, SkyLook& sky) -> Expected<void> {
        if (keys.sky.image.empty()) return wrong(place, "lacks image");
        if (keys.weight.has_value() == keys.sky.follows_sun)
          return wrong(place, "needs weight or follows_sun, one of the two");
        keys.sky.weight = keys.weight.value_or(0);
        sky.second = keys.sky;
        return {};
      },
      "a second image that is blended over the sky");
}

Row<Look> sky_row() {
  const Rows<SkyLook> rows = {
      number_row<SkyLook>("rotation_deg", {}, &SkyLook::rotation_deg,
                          "degrees about +Y, counter-clockwise seen from above"),
      number_row<SkyLook>("intensity", from_zero(), &SkyLook::intensity, "times the radiance"),
      number_row<SkyLook>("blur_deg", between(0, 90), &SkyLook::blur_deg,
                          "degrees: standard deviation by which the background is blurred, not the light"),
      flag_row<SkyLook>(
          "extract_sun", &SkyLook::extract_sun,
          "the sun of its images becomes a directional light, with shadows: true the brightest spot narrow "
          "enough for one, false none; without it what is a sun by its light, contrast and size"),
      text_row<SkyLook>("image", {}, &SkyLook::image, "as --sky takes it, from the look's folder"),
      gradient_row(),
      atmosphere_row(),
      second_row(),
  };
  return object_row<Look, SkyLook>(
      "sky", rows, [](Look&) { return SkyLook{}; },
      [](const Json&, const std::string& place, SkyLook& sky, Look& look) -> Expected<void> {
        if (!sky.image.empty() + sky.gradient.has_value() + sky.atmosphere.has_value() > 1)
          return wrong(place, "image, gradient and atmosphere are three skies; write one");
        look.sky = sky;
        return {};
      },
      "what the sky is, and how it stands and shines");
}

Row<ExposureLook> auto_exposure_row() {
  return object_row<ExposureLook, AutoExposure>(
      "auto",
      {number_row<AutoExposure>("low_percent", between(0, 100), &AutoExposure::low_percent,
                                "of the pixels, by luminance, that are darker than what is looked at"),
       number_row<AutoExposure>("high_percent", between(0, 100), &AutoExposure::high_percent,
                                "of the pixels up to which is looked at"),
       number_row<AutoExposure>("target", above_zero(), &AutoExposure::target,
                                "the exposed luminance that their geometric mean becomes"),
       number_row<AutoExposure>("min_ev", between(-100, 100), &AutoExposure::min_ev, "stops: no darker than this"),
       number_row<AutoExposure>("max_ev", between(-100, 100), &AutoExposure::max_ev, "stops: no brighter than this")},
      [](ExposureLook&) { return AutoExposure{}; },
      [](const Json&, const std::string& place, AutoExposure& a, ExposureLook& exposure) -> Expected<void> {
        if (!(a.low_percent < a.high_percent))
          return wrong(place,
                       fmt::format("low_percent {} is not below high_percent {}", a.low_percent, a.high_percent));
        if (!(a.min_ev <= a.max_ev))
          return wrong(place, fmt::format("min_ev {} is above max_ev {}", a.min_ev, a.max_ev));
        exposure.automatic = a;
        return {};
      },
      "by the frame's own luminance");
}

Row<Look> exposure_row() {
  return object_row<Look, ExposureLook>(
      "exposure",
      {auto_exposure_row(),
       number_row<ExposureLook>("ev", between(-100, 100), &ExposureLook::ev,
                                "stops by which the picture is made brighter; --exposure goes before it")},
      [](Look&) { return ExposureLook{}; },
      [](const Json&, const std::string&, ExposureLook& exposure, Look& look) -> Expected<void> {
        look.exposure = exposure;
        return {};
      },
      "how bright the picture is");
}

Row<Look> tone_row() {
  return object_row<Look, ToneMapping>(
      "tone_mapping",
      {text_row<ToneMapping>("curve",
                             {"agx", "none", "reinhard", "aces", "neutral", "reinhard-luminance", "rec709", "agx-2020"},
                             &ToneMapping::curve, "of display output; --tonemap goes before it"),
       number_row<ToneMapping>("agx_min_ev", between(-100, 100), &ToneMapping::agx_min_ev,
                               "of agx: log2 of the exposed radiance that is black"),
       number_row<ToneMapping>("agx_max_ev", between(-100, 100), &ToneMapping::agx_max_ev,
                               "of agx: log2 of the exposed radiance that is white")},
      [](Look&) { return ToneMapping{}; },
      [](const Json&, const std::string& place, ToneMapping& tone, Look& look) -> Expected<void> {
        if (!(tone.agx_max_ev - tone.agx_min_ev >= 0.1))
          return wrong(place, fmt::format("agx_min_ev {} is not below agx_max_ev {} by at least 0.1", tone.agx_min_ev,
                                          tone.agx_max_ev));
        look.tone_mapping = tone;
        return {};
      },
      "how radiance becomes display values");
}

Row<Look> shadows_row() {
  Row<ShadowLook> lights{key_of("lights", LookKey::Kind::texts, {}, "names of nodes: their lights get maps first"),
                         [](const Json& v, const std::string& at, ShadowLook& shadows) -> Expected<void> {
                           if (!v.is_array()) return wrong(at, "the value is not a list of names of nodes");
                           for (size_t i = 0; i < v.size(); ++i) {
                             if (!v[i].is_string())
                               return wrong(fmt::format("{}/{}", at, i), "the value is not a node's name");
                             shadows.lights.push_back(v[i].get<std::string>());
                           }
                           return {};
                         }};
  return object_row<Look, ShadowLook>(
      "shadows", {lights}, [](Look&) { return ShadowLook{}; },
      [](const Json&, const std::string&, ShadowLook& shadows, Look& look) -> Expected<void> {
        look.shadows = shadows;
        return {};
      },
      "which point and spot lights cast shadows before all others");
}

Row<Look> lens_row() {
  return object_row<Look, LensLook>(
      "lens",
      {number_row<LensLook>("f_stop", above_zero(), &LensLook::f_stop,
                            "focal length over the diameter of the opening; --fstop goes before it"),
       number_row<LensLook>("focus_m", above_zero(), &LensLook::focus_m,
                            "metres along the view axis to the plane of focus; --focus goes before it"),
       text_row<LensLook>("focus_node", {}, &LensLook::focus_node,
                          "instead of focus_m: the name of a node that the plane of focus goes through"),
       number_row<LensLook>("sensor_mm", above_zero(), &LensLook::sensor_mm,
                            "millimetres: height of the sensor; --sensor goes before it")},
      [](Look&) { return LensLook{}; },
      [](const Json&, const std::string& place, LensLook& lens, Look& look) -> Expected<void> {
        if ((lens.focus_m > 0) == !lens.focus_node.empty())
          return wrong(place, "needs focus_m or focus_node, one of the two");
        look.lens = lens;
        return {};
      },
      "a lens with an opening: what lies off its plane of focus is blurred");
}

Row<Look> shutter_row() {
  return object_row<Look, ShutterLook>(
      "shutter",
      {number_row<ShutterLook>("angle_deg", between(0, 360), &ShutterLook::angle_deg,
                               "degrees of 360 a frame that it is open, about the frame's time; --shutter goes before "
                               "it")},
      [](Look&) { return ShutterLook{}; },
      [](const Json&, const std::string&, ShutterLook& shutter, Look& look) -> Expected<void> {
        look.shutter = shutter;
        return {};
      },
      "how long each frame is exposed: what moves is blurred");
}

}  // namespace

const Rows<Look>& look_rows::look_table() {
  static const Rows<Look> rows = {fog_row(),     sun_row(),        lights_row(),      sky_row(),
                                  bloom_row(),   occlusion_row(),  exposure_row(),    tone_row(),
                                  shadows_row(), volumetric_row(), reflections_row(), probes_row(),
                                  lens_row(),    shutter_row(),    paths_row(),       instances_row()};
  return rows;
}

const std::vector<LookKey>& look_keys() {
  static const std::vector<LookKey> keys = [] {
    std::vector<LookKey> list;
    for (const Row<Look>& row : look_table()) list.push_back(row.key);
    return list;
  }();
  return keys;
}

std::vector<std::string> switched_on(const Look& look) {
  std::vector<std::string> names;
  const auto add = [&](bool on, std::string name) {
    if (on) names.push_back(std::move(name));
  };
  const SkyLook& sky = look.sky;
  add(look.fog.has_value(), "fog");
  add(look.volumetric.has_value(), "volumetric light");
  add(look.sun.has_value(), "the sun's disc");
  add(look.lights.radius_m > 0, "local lights of a size");
  add(!sky.image.empty(), "sky image");
  add(sky.gradient.has_value(), "sky gradient");
  add(sky.atmosphere.has_value(), "sky atmosphere");
  add(sky.second.has_value(), "second sky");
  add(sky.blur_deg > 0, "blurred background");
  add(sky.extract_sun.value_or(false), "the sky image's sun as a light");
  add(look.bloom.has_value(), "bloom");
  add(look.occlusion.has_value(), "occlusion");
  add(look.reflections.has_value(), "reflections");
  add(!look.probes.empty(), "reflection probes");
  add(look.lens.has_value(), "lens");
  add(look.shutter.has_value(), "shutter");
  add(!look.paths.empty(), "paths");
  add(!look.instances.empty(), "instances from files");
  add(!look.shadows.lights.empty(), "lights marked for shadows");
  add(look.exposure.ev.has_value(), "exposure");
  add(look.exposure.automatic.has_value(), "automatic exposure");
  add(!look.tone_mapping.curve.empty() || look.tone_mapping.agx_min_ev != agx_lowest_ev ||
          look.tone_mapping.agx_max_ev != agx_highest_ev,
      "tone mapping");
  return names;
}

}  // namespace candela
