#include "job/job.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <map>

#include "base/json.h"
#include "base/text.h"
#include "job/old_names.h"

namespace candela {
namespace {

using Json = nlohmann::ordered_json;

struct CompressionName {
  ExrCompression value;
  const char* name;
};
constexpr CompressionName compression_names[] = {{ExrCompression::none, "none"}, {ExrCompression::rle, "rle"},
                                                 {ExrCompression::zips, "zips"}, {ExrCompression::zip, "zip"},
                                                 {ExrCompression::piz, "piz"},   {ExrCompression::pxr24, "pxr24"},
                                                 {ExrCompression::b44, "b44"},   {ExrCompression::b44a, "b44a"},
                                                 {ExrCompression::dwaa, "dwaa"}, {ExrCompression::dwab, "dwab"}};

// The double that prints with the float's fewest digits: 0.1f becomes 0.1 and not 0.10000000149.
double shortest(float value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  double result = value;
  std::from_chars(digits, end, result);
  return result;
}

Json to_json(const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); }

std::string setting_text(const KnobSetting& s) { return s.pass + "." + s.knob + "=" + s.value; }

}  // namespace

std::string job_json(const Job& job) {
  Json j;
  j["scene"] = job.scene;
  j["animation"] = job.animation;
  if (!job.camera.camera.empty()) j["camera"] = job.camera.camera;
  if (job.camera.eye) j["eye"] = to_json(*job.camera.eye);
  if (job.camera.target) j["target"] = to_json(*job.camera.target);
  if (job.camera.yfov_deg) j["yfov"] = *job.camera.yfov_deg;
  if (job.camera.azimuth_deg) j["azimuth"] = *job.camera.azimuth_deg;
  if (job.camera.elevation_deg) j["elevation"] = *job.camera.elevation_deg;
  if (job.camera.fit) j["fit"] = true;
  if (job.camera.framing != Framing::boxes) j["framing"] = job.camera.framing == Framing::film ? "film" : "follow";
  if (job.camera.turn_s > 0) j["turn_s"] = job.camera.turn_s;
  j["size"] = fmt::format("{}x{}", job.width_px, job.height_px);
  if (job.region)
    j["region"] = fmt::format("{},{},{},{}", job.region->x, job.region->y, job.region->width, job.region->height);
  if (job.overscan.amount > 0)
    j["overscan"] = fmt::format("{}{}", job.overscan.amount, job.overscan.percent ? "%" : "");
  j["samples"] = job.samples;
  j["technique"] = job.technique;
  if (job.transparency != Job().transparency) j["transparency"] = job.transparency;
  if (job.sides != Job().sides) j["sides"] = job.sides;
  j["quality"] = job.quality;
  if (!job.settings.empty()) {
    j["set"] = Json::array();
    for (const KnobSetting& s : job.settings) j["set"].push_back(setting_text(s));
  }
  if (job.effects != "auto") j["effects"] = job.effects;
  if (!job.sky.empty()) j["sky"] = job.sky;
  if (!job.look.empty()) j["look"] = job.look;
  for (const PathRequest& path : job.paths) j["paths"].push_back(path_json(path));
  for (const InstancesRequest& instances : job.instances) j["instances"].push_back(instances_json(instances));
  if (job.shading != Job().shading) j["shading"] = job.shading;
  if (!job.variant.empty()) j["variant"] = job.variant;
  if (job.up != Job().up) j["up"] = job.up;
  if (job.cut_outs != Job().cut_outs) j["cut_outs"] = job.cut_outs;
  if (!job.probe.empty()) j["probe"] = job.probe;
  if (job.shutter_s) j["shutter_s"] = *job.shutter_s;
  if (job.f_stop) j["fstop"] = *job.f_stop;
  if (!job.focus.empty()) j["focus"] = job.focus;
  if (job.sensor_mm) j["sensor_mm"] = *job.sensor_mm;
  if (job.iso) j["iso"] = *job.iso;
  if (job.exposure_ev) j["exposure"] = shortest(*job.exposure_ev);
  if (!job.tonemap.empty()) j["tonemap"] = job.tonemap;
  j["view"] = job.view;
  if (!job.layers.empty()) j["layers"] = job.layers;
  if (job.view == "motion" || std::ranges::find(job.layers, "motion") != job.layers.end() ||
      (!job.look.empty() && job.motion_s != Job().motion_s))
    j["motion_s"] = job.motion_s;
  if (!job.light_groups.empty()) {
    j["light_groups"] = Json::array();
    for (const LightGroupRequest& g : job.light_groups)
      j["light_groups"].push_back(fmt::format("{}={}", g.name, fmt::join(g.nodes, ",")));
  }
  j["background"] = job.background;
  j["seed"] = job.seed;
  j["exr-type"] = job.exr_float ? "float" : "half";
  for (const CompressionName& c : compression_names)
    if (c.value == job.exr_compression) j["exr-compression"] = c.name;
  j["png-bits"] = job.png_bits;
  j["dither"] = job.dither;
  j["metadata-timings"] = job.timings_in_metadata;
  j["allow-nonfinite"] = job.allow_nonfinite;
  // Names are bytes of the file system and need not be UTF-8.
  return j.dump(-1, ' ', false, Json::error_handler_t::replace);
}

namespace {

// Reads one key into the job. Each returns an empty text, or what is wrong with the value.
using Reader = std::function<std::string(const Json&, Job&)>;

template <class T>
Reader text_into(T Job::*member) {
  return [member](const Json& v, Job& job) -> std::string {
    if (!v.is_string()) return "is not a text";
    job.*member = v.get<std::string>();
    return {};
  };
}
Reader bool_into(bool Job::*member) {
  return [member](const Json& v, Job& job) -> std::string {
    if (!v.is_boolean()) return "is not true or false";
    job.*member = v.get<bool>();
    return {};
  };
}
Reader int_into(int Job::*member) {
  return [member](const Json& v, Job& job) -> std::string {
    if (!v.is_number_integer() || v.get<int64_t>() != int(v.get<int64_t>())) return "is not a whole number";
    job.*member = v.get<int>();
    return {};
  };
}
Reader vector_into(std::optional<glm::dvec3> CameraRequest::*member) {
  return [member](const Json& v, Job& job) -> std::string {
    if (!v.is_array() || v.size() != 3 || !v[0].is_number() || !v[1].is_number() || !v[2].is_number())
      return "is not three numbers";
    job.camera.*member = glm::dvec3(v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
    return {};
  };
}
Reader number_into(std::optional<double> CameraRequest::*member) {
  return [member](const Json& v, Job& job) -> std::string {
    if (!v.is_number()) return "is not a number";
    job.camera.*member = v.get<double>();
    return {};
  };
}
Reader number_into(std::optional<double> Job::*member) {
  return [member](const Json& v, Job& job) -> std::string {
    if (!v.is_number()) return "is not a number";
    job.*member = v.get<double>();
    return {};
  };
}
std::string read_size(const Json& v, Job& job) {
  const auto size = v.is_string() ? parse_size(v.get<std::string>()) : fail(ErrorKind::input, "", "");
  if (!size) return "is not a size such as \"1280x720\"";
  std::tie(job.width_px, job.height_px) = *size;
  return {};
}
std::string read_settings(const Json& v, Job& job) {
  if (!v.is_array()) return "is not a list";
  for (const Json& entry : v) {
    const auto setting =
        entry.is_string() ? parse_knob_setting(entry.get<std::string>()) : fail(ErrorKind::input, "", "");
    if (!setting) return "holds something other than \"PASS.KNOB=VALUE\"";
    job.settings.push_back(*setting);
  }
  return {};
}
std::string read_layers(const Json& v, Job& job) {
  if (!v.is_array()) return "is not a list";
  for (const Json& entry : v) {
    if (!entry.is_string()) return "holds something other than a name";
    job.layers.push_back(entry.get<std::string>());
  }
  return {};
}

template <class T>
Reader motion_into(std::vector<T> Job::*member, Expected<T> (*read)(const Json&, const std::string&)) {
  return [=](const Json& v, Job& job) -> std::string {
    if (!v.is_array()) return "is not a list";
    for (const Json& entry : v) {
      auto value = read(entry, "");
      if (!value) return "is refused: " + value.error().text();
      (job.*member).push_back(std::move(*value));
    }
    return {};
  };
}
// Of a text in a form that has a function of its own.
template <class T, class Member>
Reader parsed_into(Member Job::*member, Expected<T> (*parse)(const std::string&)) {
  return [member, parse](const Json& v, Job& job) -> std::string {
    if (!v.is_string()) return "is not a text";
    const auto parsed = parse(v.get<std::string>());
    if (!parsed) return "is wrong: " + parsed.error().message;
    job.*member = *parsed;
    return {};
  };
}
std::string read_light_groups(const Json& v, Job& job) {
  if (!v.is_array()) return "is not a list";
  for (const Json& entry : v) {
    const auto group = parse_light_group(entry.is_string() ? entry.get<std::string>() : "");
    if (!group) return "holds something other than \"NAME=NODE,NODE\"";
    job.light_groups.push_back(*group);
  }
  return {};
}

const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> table = {
      {"scene", text_into(&Job::scene)},
      {"animation", text_into(&Job::animation)},
      {"camera",
       [](const Json& v, Job& job) -> std::string {
         if (!v.is_string()) return "is not a text";
         job.camera.camera = v.get<std::string>();
         return {};
       }},
      {"eye", vector_into(&CameraRequest::eye)},
      {"target", vector_into(&CameraRequest::target)},
      {"yfov", number_into(&CameraRequest::yfov_deg)},
      {"azimuth", number_into(&CameraRequest::azimuth_deg)},
      {"elevation", number_into(&CameraRequest::elevation_deg)},
      {"fit",
       [](const Json& v, Job& job) -> std::string {
         if (!v.is_boolean()) return "is not true or false";
         job.camera.fit = v.get<bool>();
         return {};
       }},
      {"framing",
       [](const Json& v, Job& job) -> std::string {
         if (v == "film")
           job.camera.framing = Framing::film;
         else if (v == "follow")
           job.camera.framing = Framing::follow;
         else if (v != "boxes")
           return "is not film, follow or boxes";
         return {};
       }},
      {"turn_s",
       [](const Json& v, Job& job) -> std::string {
         if (!v.is_number()) return "is not a number";
         job.camera.turn_s = v.get<double>();
         return {};
       }},
      {"size", read_size},
      {"region", parsed_into(&Job::region, parse_pixel_rect)},
      {"overscan", parsed_into(&Job::overscan, parse_overscan)},
      {"light_groups", read_light_groups},
      {"samples", int_into(&Job::samples)},
      {"technique", text_into(&Job::technique)},
      {"transparency", text_into(&Job::transparency)},
      {"sides", text_into(&Job::sides)},
      {"quality", text_into(&Job::quality)},
      {"set", read_settings},
      {"effects", text_into(&Job::effects)},
      {"sky", text_into(&Job::sky)},
      {"look", text_into(&Job::look)},
      {"paths", motion_into(&Job::paths, path_from_json)},
      {"instances", motion_into(&Job::instances, instances_from_json)},
      {"shading", text_into(&Job::shading)},
      {"variant", text_into(&Job::variant)},
      {"cut_outs", text_into(&Job::cut_outs)},
      {"probe", text_into(&Job::probe)},
      {"shutter_s", number_into(&Job::shutter_s)},
      {"fstop", number_into(&Job::f_stop)},
      {"focus", text_into(&Job::focus)},
      {"sensor_mm", number_into(&Job::sensor_mm)},
      {"iso", number_into(&Job::iso)},
      {"exposure",
       [](const Json& v, Job& job) -> std::string {
         if (!v.is_number()) return "is not a number";
         job.exposure_ev = v.get<float>();
         return {};
       }},
      {"tonemap", text_into(&Job::tonemap)},
      {"up", text_into(&Job::up)},
      {"view", text_into(&Job::view)},
      {"layers", read_layers},
      {"motion_s",
       [](const Json& v, Job& job) -> std::string {
         if (!v.is_number() || !(v.get<double>() > 0)) return "is not a number above 0";
         job.motion_s = v.get<double>();
         return {};
       }},
      {"background", text_into(&Job::background)},
      {"seed",
       [](const Json& v, Job& job) -> std::string {
         if (!v.is_number_unsigned()) return "is not a whole number of at least 0";
         job.seed = v.get<uint64_t>();
         return {};
       }},
      {"exr-type",
       [](const Json& v, Job& job) -> std::string {
         if (v != "half" && v != "float") return "is neither half nor float";
         job.exr_float = v == "float";
         return {};
       }},
      {"exr-compression",
       [](const Json& v, Job& job) -> std::string {
         const auto c = exr_compression_from_name(v.is_string() ? v.get<std::string>() : "");
         if (!c) return "is not a compression: " + c.error().message;
         job.exr_compression = *c;
         return {};
       }},
      {"png-bits", int_into(&Job::png_bits)},
      {"dither", bool_into(&Job::dither)},
      {"metadata-timings", bool_into(&Job::timings_in_metadata)},
      {"allow-nonfinite", bool_into(&Job::allow_nonfinite)},
  };
  return table;
}

}  // namespace

Expected<Job> job_from_json(const std::string& text) {
  const auto j = read_json(text, "");
  if (!j) return std::unexpected(j.error());
  if (!j->is_object()) return fail(ErrorKind::input, "", "a job is a JSON object");
  Job job;
  for (const auto& [key, value] : j->items()) {
    const auto reader = readers().find(key);
    if (reader == readers().end()) {
      std::vector<std::string> names;
      for (const auto& entry : readers()) names.push_back(entry.first);
      return fail(ErrorKind::input, "/" + key, "{}", unknown_name("key", key, names));
    }
    if (const std::string wrong = reader->second(value, job); !wrong.empty())
      return fail(ErrorKind::input, "/" + key, "the value {}", wrong);
  }
  take_new_names(job);
  return job;
}

Expected<std::pair<int, int>> parse_size(const std::string& text) {
  static const std::map<std::string_view, std::pair<int, int>> names = {
      {"720p", {1280, 720}},   {"1080p", {1920, 1080}}, {"1440p", {2560, 1440}},
      {"2160p", {3840, 2160}}, {"4320p", {7680, 4320}}, {"4k", {3840, 2160}},
      {"4K", {3840, 2160}},    {"8k", {7680, 4320}},    {"8K", {7680, 4320}}};
  if (const auto named = names.find(text); named != names.end()) return named->second;
  int width = 0, height = 0;
  const char *begin = text.data(), *end = begin + text.size();
  const auto w = std::from_chars(begin, end, width);
  if (w.ec == std::errc{} && w.ptr != end && *w.ptr == 'x') {
    const auto h = std::from_chars(w.ptr + 1, end, height);
    if (h.ec == std::errc{} && h.ptr == end) return std::pair(width, height);
  }
  return fail(ErrorKind::usage, "",
              "'{}' is not a size; write WIDTHxHEIGHT in pixels, for example 1280x720, or 720p, 1080p, 1440p, 4k or 8k",
              text);
}

Expected<KnobSetting> parse_knob_setting(const std::string& text) {
  const size_t dot = text.find('.'), equals = text.find('=');
  if (dot == std::string::npos || equals == std::string::npos || dot == 0 || equals < dot + 2 ||
      equals + 1 == text.size())
    return fail(ErrorKind::usage, "", "'{}' is not a setting; write PASS.KNOB=VALUE (`candela list knobs` prints them)",
                text);
  KnobSetting setting{text.substr(0, dot), text.substr(dot + 1, equals - dot - 1), text.substr(equals + 1)};
  take_new_names(setting);
  return setting;
}

void forget_motion_files(Job& job) {
  for (PathRequest& path : job.paths) {
    path.points = "points";
    if (!path.times.empty()) path.times = "times";
  }
  for (InstancesRequest& instances : job.instances) instances.file = "instances";
}

Hash128 frame_identity(const Job& job, const std::string& scene_content, const std::string& device, double time_s) {
  // The files' content is hashed, so where they lie does not matter.
  Job nowhere = job;
  nowhere.scene.clear();
  if (!nowhere.sky.empty() && !is_sky_word(nowhere.sky)) nowhere.sky = "sky";
  if (!nowhere.look.empty()) nowhere.look = "look";
  forget_motion_files(nowhere);
  return hash128(
      fmt::format("candela {}\n{}\n{}\n{}\n{:a}", CANDELA_VERSION, job_json(nowhere), scene_content, device, time_s));
}

}  // namespace candela
