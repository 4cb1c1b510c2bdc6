#include "base/text.h"
#include "job/background.h"
#include "job/choose_transparency.h"
#include "job/dump_request.h"
#include "job/frame_choices.h"
#include "job/job.h"
#include "job/light_groups.h"
#include "job/picture_window.h"
#include "scene/cut_outs.h"
#include "scene/probe.h"
#include "scene/shading.h"
#include "scene/up_axis.h"

namespace candela {
namespace {

Expected<void> check_name(const char* option, const char* what, const std::string& name,
                          const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) != names.end()) return {};
  return fail(ErrorKind::usage, option, "{}", unknown_name(what, name, names));
}

// With the layers of its groups of lights.
std::vector<std::string> views_of(const Job& job) {
  std::vector<std::string> names = view_names();
  for (std::string& layer : light_group_layers(job)) names.push_back(std::move(layer));
  return names;
}

std::vector<std::string> shading_names() {
  std::vector<std::string> names;
  for (const ShadingName& shading : shadings()) names.push_back(shading.name);
  return names;
}

Expected<void> check_settings(const Job& job) {
  if (job.settings.empty()) return {};
  const std::vector<KnobRow> rows = knob_rows(job.quality);
  for (const KnobSetting& setting : job.settings) {
    std::vector<std::string> passes, knobs;
    for (const KnobRow& row : rows) {
      if (passes.empty() || passes.back() != row.pass) passes.push_back(row.pass);
      if (row.pass == setting.pass) knobs.push_back(row.knob);
    }
    if (knobs.empty()) return check_name("--set", "pass with knobs", setting.pass, passes);
    if (auto known = check_name("--set", "knob", setting.knob, knobs); !known) return known;
  }
  return {};
}

Expected<void> check_shutter(const Job& job) {
  const auto is = [](const std::optional<double>& value, double above) {
    return !value || (std::isfinite(*value) && *value >= above);
  };
  if (!is(job.shutter_s, 0))
    return fail(ErrorKind::usage, "--shutter", "{} s is not an exposure time; it must be at least 0", *job.shutter_s);
  if (!is(job.f_stop, 0))
    return fail(ErrorKind::usage, "--fstop", "{} is not an f-stop; it must be at least 0", *job.f_stop);
  if (!is(job.sensor_mm, 1e-3))
    return fail(ErrorKind::usage, "--sensor", "{} mm is not the height of a sensor; it must be at least 0.001",
                *job.sensor_mm);
  if (!is(job.iso, 1e-3))
    return fail(ErrorKind::usage, "--iso", "{} is not the speed of a sensor; it must be at least 0.001", *job.iso);
  return {};
}

Expected<void> check_direction(const CameraRequest& camera) {
  const bool turns = camera.turn_s > 0, direction = camera.azimuth_deg || camera.elevation_deg || turns;
  const char* option = turns ? "--turntable" : camera.azimuth_deg ? "--azimuth" : "--elevation";
  if (camera.azimuth_deg && !std::isfinite(*camera.azimuth_deg))
    return fail(ErrorKind::usage, "--azimuth", "{} is not an angle in degrees", *camera.azimuth_deg);
  if (camera.elevation_deg && !(std::abs(*camera.elevation_deg) <= 90))
    return fail(ErrorKind::usage, "--elevation", "{} is outside -90 to 90 degrees", *camera.elevation_deg);
  if (!(camera.turn_s >= 0) || !std::isfinite(camera.turn_s))
    return fail(ErrorKind::usage, "--turntable", "{} s is not the duration of a turn", camera.turn_s);
  if (direction && (camera.eye || !camera.camera.empty()))
    return fail(ErrorKind::usage, option, "places the camera itself; it does not go with --camera, --eye and --target");
  if (camera.fit && camera.eye)
    return fail(ErrorKind::usage, "--fit", "places the camera itself; it does not go with --eye and --target");
  return {};
}

Expected<void> check_camera_path(const Job& job) {
  if (std::ranges::none_of(job.paths, [](const PathRequest& path) { return path.target == "camera"; })) return {};
  const CameraRequest& camera = job.camera;
  for (const auto& [option, given] : {std::pair("--eye", camera.eye.has_value()),
                                      {"--azimuth", camera.azimuth_deg.has_value()},
                                      {"--elevation", camera.elevation_deg.has_value()},
                                      {"--turntable", camera.turn_s > 0},
                                      {"--fit", camera.fit}})
    if (given)
      return fail(ErrorKind::usage, option, "places the camera, and so does --camera-path: give one of the two");
  return {};
}

}  // namespace

Expected<void> check_compression(const std::vector<std::string>& layers, ExrCompression compression) {
  using enum ExrCompression;
  const auto matte = std::ranges::find_if(
      layers, [](const std::string& layer) { return layer == "crypto_object" || layer == "crypto_material"; });
  if (matte == layers.end() || (compression != pxr24 && compression != dwaa && compression != dwab)) return {};
  return fail(ErrorKind::usage, "--exr-compression",
              "pxr24, dwaa and dwab change the 32-bit floats whose bits are the ids of {}; use zip, zips, piz, rle or "
              "none, or leave the layer out",
              *matte);
}

Expected<void> check_job(const Job& job) {
  if (auto fits = check_window(job); !fits) return fits;
  constexpr std::array<int, 5> sample_counts = {0, 1, 2, 4, 8};  // 0: as the quality says
  if (std::find(sample_counts.begin(), sample_counts.end(), job.samples) == sample_counts.end())
    return fail(ErrorKind::usage, "--samples", "{} is none of 1, 2, 4 and 8", job.samples);
  if (job.png_bits != 8 && job.png_bits != 16)
    return fail(ErrorKind::usage, "--png-bits", "{} is neither 8 nor 16", job.png_bits);
  if (const float ev = job.exposure_ev.value_or(0); !std::isfinite(ev) || std::abs(ev) > 100)
    return fail(ErrorKind::usage, "--exposure", "{} is outside -100 to 100 stops", ev);
  if (job.camera.eye.has_value() != job.camera.target.has_value())
    return fail(ErrorKind::usage, job.camera.eye ? "--target" : "--eye", "--eye and --target go together");
  if (job.camera.eye && !job.camera.camera.empty())
    return fail(ErrorKind::usage, "--camera", "a camera is chosen either by --camera or by --eye and --target");
  if (job.camera.yfov_deg && !(*job.camera.yfov_deg > 0 && *job.camera.yfov_deg < 180))
    return fail(ErrorKind::usage, "--yfov", "{} is outside 0 to 180 degrees", *job.camera.yfov_deg);
  if (auto good = check_direction(job.camera); !good) return good;
  if (auto good = check_shutter(job); !good) return good;
  if (auto good = check_camera_path(job); !good) return good;
  static const std::vector<std::string> qualities = {"draft", "normal", "high", "exact"};
  if (job.technique != auto_technique)
    if (auto known = check_name("--technique", "technique", job.technique, technique_names()); !known) return known;
  if (job.transparency != auto_transparency)
    if (auto known = check_name("--transparency", "method of transparency", job.transparency, transparency_names());
        !known)
      return known;
  static const std::vector<std::string> sides = {"auto", "block", "open"};
  if (auto known = check_name("--sides", "choice", job.sides, sides); !known) return known;
  if (auto known = check_name("--quality", "quality", job.quality, qualities); !known) return known;
  if (!job.tonemap.empty())
    if (auto known = check_name("--tonemap", "tone map", job.tonemap, tonemap_names()); !known) return known;
  if (auto known = check_name("--cut-outs", "way of drawing cut-outs", job.cut_outs, cut_out_choices()); !known)
    return known;
  if (auto known = check_name("--shading", "shading", job.shading, shading_names()); !known) return known;
  if (auto known = check_name("--up", "axis", job.up, up_axes()); !known) return known;
  if (!job.probe.empty())
    if (auto known = check_name("--probe", "probe", job.probe, probe_names()); !known) return known;
  if (!image_of_view(job.view))
    if (auto known = check_name("--view", "view", job.view, views_of(job)); !known) return known;
  if (job.effects != "auto" && job.effects != "none")
    for (const std::string& effect : split(job.effects, ',')) {
      static const std::map<std::string, std::string> others = {
          {"ao", "occlusion"}, {"ssao", "occlusion"}, {"gtao", "occlusion"}};
      if (const auto other = others.find(effect); other != others.end())
        return fail(ErrorKind::usage, "--effects", "there is no effect '{}'; it is called {} here", effect,
                    other->second);
      if (auto known = check_name("--effects", "effect", effect, effect_names()); !known) return known;
    }
  for (const std::string& layer : job.layers)
    if (layer != all_layers)
      if (auto known = check_name("--layers", "layer", layer, layer_names()); !known) return known;
  if (auto good = check_light_groups(job.light_groups); !good) return good;
  if (auto good = check_compression(job.layers, job.exr_compression); !good) return good;
  if (auto good = parse_background(job.background); !good) return std::unexpected(good.error());
  return check_settings(job);
}

}  // namespace candela
