#pragma once
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "look/motion.h"

namespace candela {

// Beyond this the phase function is a spike that neither a grid nor a lobe of 16-bit numbers holds.
inline constexpr double largest_anisotropy = 0.98;

// Air that absorbs, scatters and glows. Everything is in world space, metres and linear Rec.709. What stands per metre
// holds where the density is 1; everywhere else it is multiplied by the density exp(-falloff * (y - height)), and
// outside the bounds there is nothing. Where several media overlap the air is their sum.
struct Fog {
  glm::dvec3 extinction_per_m{0};  // absorption and scattering together
  glm::dvec3 scattering_per_m{0};  // no larger than the extinction
  glm::dvec3 emission_per_m{0};    // radiance that a metre adds, cd/m2 per m; 0 where the extinction is
  double anisotropy = 0;           // g of Henyey and Greenstein: above 0 light goes on, below 0 it comes back
  double falloff_per_m = 0;
  double height_m = 0;
  glm::dvec3 lowest{-std::numeric_limits<double>::infinity()}, highest{std::numeric_limits<double>::infinity()};
  double turn_rad = 0;  // of the bounds about +Y through their middle, counter-clockwise seen from above
  bool operator==(const Fog&) const = default;
};
inline constexpr size_t most_fog_boxes = 8;

// Nothing at an infinite distance comes through.
inline bool is_endless(const Fog& fog) {
  return fog.extinction_per_m != glm::dvec3(0) && fog.falloff_per_m == 0 && glm::all(glm::isinf(fog.lowest)) &&
         glm::all(glm::isinf(fog.highest));
}

// The directional lights' disc in the sky. The real sun's angular radius is the default where a look names the sun.
inline constexpr double largest_sun_radius_deg = 45;
struct Sun {
  double angular_radius_deg = 0.2666;  // 0: a point, with hard shadows
  bool operator==(const Sun&) const = default;
};

// Point and spot lights that say nothing of their size (CANDELA_light_size).
struct LampLook {
  double radius_m = 0;  // of a sphere; 0: points, with hard shadows
  bool operator==(const LampLook&) const = default;
};

// Light that lens and eye scatter round bright things: a sum of Gaussians of what is above the threshold. Level k (from
// 0) has a weight and the variance 1.5 (4^(k+1) - 1) square pixels of the picture.
struct Bloom {
  double strength = 0.04;  // share of the light that is scattered
  double threshold = 0;    // exposed radiance; less does not glow
  double knee = 0;         // half the width over which the threshold sets in
  std::vector<double> weights = {1, 1, 1, 1, 1};
  bool keeps = true;       // what is scattered is taken from where it came; otherwise it is added
  bool in_beauty = false;  // in linear output too, not only on display
  // What surfaces emit glows, and nothing that is merely lit or lies behind them: a glow mask.
  bool of_emission = false;
  static double variance_px2(size_t level) { return 1.5 * (double(uint64_t(1) << (2 * (level + 1))) - 1); }
  bool operator==(const Bloom&) const = default;
};

// A sky without an image. With e the sine of the elevation: horizon + (zenith - horizon) e^exponent above the horizon,
// horizon + (ground - horizon) (-e)^exponent below. Radiance.
struct SkyGradient {
  glm::dvec3 zenith{0.25, 0.45, 0.9}, horizon{0.8, 0.85, 0.9}, ground{0.2, 0.18, 0.16};
  double exponent = 0.5;
  bool operator==(const SkyGradient&) const = default;
};

// Air of the Earth under the scene's first directional light (scene/atmosphere.h).
struct Atmosphere {
  double haze = 1;             // times the Earth's aerosols
  double ozone = 1;            // times the Earth's ozone
  double ground_albedo = 0.1;  // of the ground below the horizon
  double altitude_m = 200;     // of the observer
  // Of the sun above the air, lux; absent: the light's own.
  std::optional<glm::dvec3> sun_lux;
  bool operator==(const Atmosphere&) const = default;
};

// A second image over the first: the sky is (1 - weight) first + weight second.
struct SecondSky {
  std::string image;         // as the file names it
  double intensity = 1;      // times this image's radiance
  double weight = 0;         // 0 to 1
  bool follows_sun = false;  // the weight is 1 - smoothstep(from, to, elevation of the first directional light)
  double from_deg = -18, to_deg = 0;
  bool operator==(const SecondSky&) const = default;
};

// What the sky is, and how it stands and shines. At most one of image, gradient and atmosphere; an image of the command
// line takes their place.
struct SkyLook {
  double rotation_deg = 0;  // about +Y, counter-clockwise seen from above
  double intensity = 1;     // times the radiance
  double blur_deg = 0;      // standard deviation by which the background is blurred; light is not
  // The sun of its images becomes a directional light, with shadows: where there is one, never, or whatever is
  // brightest.
  std::optional<bool> extract_sun;
  std::string image;  // as the file names it
  std::optional<SecondSky> second;
  std::optional<SkyGradient> gradient;
  std::optional<Atmosphere> atmosphere;
  bool operator==(const SkyLook&) const = default;
};

// Exposure by the frame's own luminance: the mean of log2 of the luminances between two percentiles of the picture
// comes out as middle grey.
struct AutoExposure {
  double low_percent = 50, high_percent = 95;
  double target = 0.18;  // exposed luminance of that mean
  double min_ev = -16, max_ev = 16;
  bool operator==(const AutoExposure&) const = default;
};
// Options of the command line replace these values.
struct ExposureLook {
  std::optional<double> ev;  // stops; with automatic exposure on top of it
  std::optional<AutoExposure> automatic;
  bool operator==(const ExposureLook&) const = default;
};
inline constexpr double agx_lowest_ev = -12.47393, agx_highest_ev = 4.026069;
struct ToneMapping {
  std::string curve;                                               // empty: not said
  double agx_min_ev = agx_lowest_ev, agx_max_ev = agx_highest_ev;  // stops of exposed radiance
  bool operator==(const ToneMapping&) const = default;
};

// How surfaces near a point hide the sky from it. A ray that meets a surface at distance t is hidden by
// saturate((radius - t) / (falloff * radius)): wholly up to (1 - falloff) radii, and beyond the radius not at all.
struct Occlusion {
  double radius_m = std::numeric_limits<double>::infinity();  // farther surfaces hide nothing
  double falloff = 0.6;  // part of the radius over which the effect fades; 0: a hard end
  double strength = 1;   // of the darkening, 0 to 1
  double hidden(double t_m) const {
    if (!(t_m < radius_m)) return 0;
    if (std::isinf(radius_m)) return 1;
    const double from_end = radius_m - t_m, width = falloff * radius_m;
    return from_end >= width ? 1 : from_end / width;
  }
  bool operator==(const Occlusion&) const = default;
};

// The point and spot lights that shadow maps are given to first, by the names of their nodes.
struct ShadowLook {
  std::vector<std::string> lights;
  bool operator==(const ShadowLook&) const = default;
};

// Light of point and spot lights that the air scatters, added to the picture: along each camera ray up to the first
// opaque surface, the integral of phi I(d) p(cosine) e^(-tau d) e^(-tau s) C ds. I(d) is a lamp's illuminance at
// distance d, s the distance from the camera, p the phase function. C is tau (air that only scatters), or the lamp's
// attenuation over its range, (1 - (d/range)^4), per metre.
struct Volumetric {
  double phi = 1;
  double tau_per_m = 0.02;
  double anisotropy = 0;        // as Fog's
  bool by_attenuation = false;  // C
  bool operator==(const Volumetric&) const = default;
};

// Opaque and masked surfaces reflect each other: where a direction of the specular lobe meets a surface, the light of
// lamps and sky on that surface replaces the sky's light. There is only one reflection.
struct ReflectionLook {
  bool operator==(const ReflectionLook&) const = default;
};

// An image of the scene in all directions from a point, taken once. Surfaces in the box reflect it instead of the sky,
// as if everything in it lay on the box's faces. World space, metres; does not change over time.
struct ReflectionProbe {
  glm::dvec3 position{0}, lowest{0}, highest{0};
  double fade_m = 0.1;  // distance outside the box over which the probe fades out
  double time_s = 0;    // of the scene that it shows
  bool operator==(const ReflectionProbe&) const = default;
};
inline constexpr size_t most_reflection_probes = 8;
inline constexpr size_t most_motion_files = 1024;  // paths of a look, and instances

// A thin lens: what lies off its plane of focus is blurred.
struct LensLook {
  double f_stop = 2.8;     // focal length over the diameter of the opening
  double focus_m = 0;      // along the view axis; infinity: far away; 0: not given
  std::string focus_node;  // the plane goes through the node of this name; empty: focus_m counts
  double sensor_mm = 24;   // height of the sensor, which with the field of view gives the focal length
  bool operator==(const LensLook&) const = default;
};
// The shutter is open for so many degrees of 360 a frame, half before the frame's time and half after it.
struct ShutterLook {
  double angle_deg = 180;
  bool operator==(const ShutterLook&) const = default;
};

// The contents of a look file.
struct Look {
  std::optional<Fog> fog;
  std::vector<Fog> more_fog;  // media beside the first
  std::optional<Bloom> bloom;
  std::optional<Sun> sun;
  LampLook lights;
  SkyLook sky;
  std::optional<Occlusion> occlusion;
  std::optional<ReflectionLook> reflections;  // absent: surfaces reflect the sky alone
  ExposureLook exposure;
  ToneMapping tone_mapping;
  ShadowLook shadows;
  std::optional<Volumetric> volumetric;
  std::vector<ReflectionProbe> probes;  // smaller boxes first, which take precedence
  std::optional<LensLook> lens;         // absent: a pinhole
  std::optional<ShutterLook> shutter;   // absent: an instant
  std::vector<PathRequest> paths;       // files from the look's folder; the same for all times
  std::vector<InstancesRequest> instances;
  bool operator==(const Look&) const = default;
};
// Number of media whose densities are summed; 0: a single medium without rotation, which has closed forms.
inline size_t summed_fog(const Look& look) {
  return look.fog && (!look.more_fog.empty() || look.fog->turn_rad != 0) ? 1 + look.more_fog.size() : 0;
}
inline bool any_fog(const Look& look, const auto& is) {
  return look.fog && (is(*look.fog) || std::ranges::any_of(look.more_fog, is));
}
inline bool fog_scatters(const Look& look) {
  return any_fog(look, [](const Fog& f) { return f.scattering_per_m != glm::dvec3(0); });
}
inline bool fog_glows(const Look& look) {
  return any_fog(look, [](const Fog& f) { return f.emission_per_m != glm::dvec3(0); });
}
// Names of what the look switches on: "fog", "bloom". Empty: nothing.
std::vector<std::string> switched_on(const Look& look);

// A look file is strict JSON (docs/using/look.md has the keys). Unknown and repeated keys, wrong types, and values that
// are negative, not finite or contradict each other are errors (input) that name file and JSON path.
//
// Any number, list of numbers or colour may stand as {"keys": [[time in seconds, value], ...]} with ascending times: it
// is then interpolated between them, and constant before the first and after the last. "interpolation" beside it is
// linear, step, or cubic: monotone pieces (Fritsch and Carlson, "Monotone Piecewise Cubic Interpolation", 1980), which
// stay between their keys, so that values that are right at the keys are right between them.
//
// A look that was read once; each frame evaluates it at its own time, finding keys by bisection.
class LookFile {
 public:
  struct Parsed;
  explicit LookFile(std::shared_ptr<const Parsed> parsed) : parsed_(std::move(parsed)) {}
  Expected<Look> at(double time_s = 0) const;

 private:
  std::shared_ptr<const Parsed> parsed_;
};
// Reads the file and checks it at the times of all keys.
Expected<LookFile> read_look_file(const std::filesystem::path& file);
Expected<Look> read_look(const std::filesystem::path& file, double time_s = 0);
Expected<Look> look_from_json(const std::string& text, const std::string& place, double time_s = 0);

// The look's paths and instances alone, without reading what changes over time.
Expected<Look> read_look_motion(const std::filesystem::path& file);

// NAME.look.json beside NAME.gltf or NAME.glb, or empty where there is none.
std::filesystem::path look_beside(const std::filesystem::path& scene);

// The keys that the reader takes, as a tree: what the reader checks and docs/schemas/look.schema.json says.
struct LookKey {
  enum class Kind : uint8_t { object, objects, number, numbers, color, flag, text, texts };
  std::string name, help;
  Kind kind = Kind::number;
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool above_low = false;            // low itself is not allowed
  size_t least = 0, most = 0;        // of numbers: how many
  std::vector<std::string> choices;  // of text
  bool fixed = false;                // the same at all times
  std::vector<LookKey> keys;         // of object, and of each of objects
};
const std::vector<LookKey>& look_keys();
std::string look_schema();  // JSON Schema, draft 2020-12

}  // namespace candela
