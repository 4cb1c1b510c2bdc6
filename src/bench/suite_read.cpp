#include "base/files.h"
#include "base/input.h"
#include "bench/suite.h"
#include "bench/suite_file.h"
#include "testscenes/make_scene.h"

namespace candela {
namespace fs = std::filesystem;
using namespace suite_file;
namespace {

constexpr std::string_view assets_prefix = "assets:";

Expected<double> time_of(const Json& j, const SuitePlace& place) {
  if (!j.is_number()) return place.wrong("is not a number of seconds");
  return j.get<double>();
}

// {"lights.test": ["aabb", "capsule"], "lights.mask": 1}
Expected<void> read_sweeps(const Json& j, const SuitePlace& place, std::vector<KnobSweep>& into) {
  if (!j.is_object()) return place.wrong("is not an object of knobs");
  into.clear();
  for (const auto& [knob, values] : j.items()) {
    const auto name = parse_knob_setting(knob + "=0");
    if (!name) return fail(ErrorKind::input, place.at, "'{}' is not the name of a knob; write PASS.KNOB", knob);
    KnobSweep sweep{name->pass, name->knob, {}};
    auto value_of = [](const Json& v, const SuitePlace& at) -> Expected<std::string> {
      if (v.is_string()) return v.get<std::string>();
      if (v.is_boolean()) return std::string(v.get<bool>() ? "1" : "0");
      if (v.is_number()) return v.dump();
      return at.wrong("is neither a number nor a name");
    };
    if (auto read = read_list(values, place.inside(knob), sweep.values, value_of); !read) return read;
    into.push_back(std::move(sweep));
  }
  return {};
}

Expected<std::optional<glm::dvec3>> point_of(const Json& j, const SuitePlace& place) {
  if (!j.is_array() || j.size() != 3 || !j[0].is_number() || !j[1].is_number() || !j[2].is_number())
    return place.wrong("is not three numbers");
  return glm::dvec3(j[0].get<double>(), j[1].get<double>(), j[2].get<double>());
}

template <std::optional<glm::dvec3> CameraRequest::*member>
Expected<void> read_point(const Json& j, const SuitePlace& place, SuiteScene& scene) {
  const auto point = point_of(j, place);
  if (!point) return std::unexpected(point.error());
  scene.camera.*member = *point;
  return {};
}

// A sky or a look, below the file's folder or that of the assets.
template <SuiteFile SuiteScene::*member>
Expected<void> read_named_file(const Json& j, const SuitePlace& place, SuiteScene& scene) {
  const auto text = text_of(j, place);
  if (!text) return std::unexpected(text.error());
  const bool asset = text->starts_with(assets_prefix);
  const fs::path& home = asset ? place.assets : place.folder;
  const std::string below = asset ? text->substr(assets_prefix.size()) : *text;
  const fs::path file = (home / below).lexically_normal();
  scene.*member = {*text, file.string()};
  std::error_code failed;
  if (asset && !fs::is_directory(home, failed)) {
    scene.missing = fmt::format("there is no folder of assets at {}", home.string());
    return {};
  }
  if (auto allowed = check_named_file(file, home, place.at); !allowed)
    return fail(ErrorKind::input, place.at, "{}", allowed.error().message);
  return {};
}

// A scene that the file names: generated, or below the file's folder or that of the assets.
Expected<SuiteScene> named_scene(const std::string& text, const SuitePlace& place) {
  SuiteScene scene = suite_scene(text, place.folder, place.assets);
  if (scene.file.empty() || !scene.missing.empty()) return scene;
  const fs::path& home = text.starts_with(assets_prefix) ? place.assets : place.folder;
  if (auto allowed = check_named_file(scene.file, home, place.at); !allowed)
    return fail(ErrorKind::input, place.at, "{}", allowed.error().message);
  return scene;
}

Expected<SuiteScene> scene_of(const Json& j, const SuitePlace& place) {
  if (j.is_string()) return named_scene(j.get<std::string>(), place);
  if (!j.is_object()) return place.wrong("is neither a scene nor an object with the key \"scene\"");
  if (!j.contains("scene")) return fail(ErrorKind::input, place.at + "/scene", "is missing");
  static const Readers<SuiteScene> readers = {
      {"scene",
       [](const Json& v, const SuitePlace& at, SuiteScene& scene) -> Expected<void> {
         const auto text = text_of(v, at);
         if (!text) return std::unexpected(text.error());
         const auto named = named_scene(*text, at);
         if (!named) return std::unexpected(named.error());
         scene.label = named->label, scene.file = named->file;
         if (!named->missing.empty()) scene.missing = named->missing;
         return {};
       }},
      {"lights", [](const Json& v, const SuitePlace& at,
                    SuiteScene& scene) { return read_list(v, at, scene.lights, whole_of(0)); }},
      {"seed", [](const Json& v, const SuitePlace& at,
                  SuiteScene& scene) { return read_whole(v, at, uint64_t(0), scene.seed.emplace()); }},
      {"camera",
       [](const Json& v, const SuitePlace& at, SuiteScene& scene) { return read_text(v, at, scene.camera.camera); }},
      {"yfov", [](const Json& v, const SuitePlace& at,
                  SuiteScene& scene) { return read_positive(v, at, scene.camera.yfov_deg.emplace()); }},
      {"eye", read_point<&CameraRequest::eye>},
      {"target", read_point<&CameraRequest::target>},
      {"sky", read_named_file<&SuiteScene::sky>},
      {"look", read_named_file<&SuiteScene::look>},
  };
  SuiteScene scene;
  if (auto read = read_keys(j, place, readers, scene); !read) return std::unexpected(read.error());
  return scene;
}

// A number of views, or a list of them: {"eye": [..], "target": [..], "time": 2}.
Expected<void> read_views(const Json& j, const SuitePlace& place, Suite& suite) {
  if (!j.is_array()) return read_whole(j, place, 1, suite.view_count);
  struct Read {
    SuiteScene camera;
    double time_s = 0;
  };
  static const Readers<Read> readers = {
      {"camera",
       [](const Json& v, const SuitePlace& at, Read& view) { return read_text(v, at, view.camera.camera.camera); }},
      {"yfov", [](const Json& v, const SuitePlace& at,
                  Read& view) { return read_positive(v, at, view.camera.camera.yfov_deg.emplace()); }},
      {"eye", [](const Json& v, const SuitePlace& at,
                 Read& view) { return read_point<&CameraRequest::eye>(v, at, view.camera); }},
      {"target", [](const Json& v, const SuitePlace& at,
                    Read& view) { return read_point<&CameraRequest::target>(v, at, view.camera); }},
      {"time",
       [](const Json& v, const SuitePlace& at, Read& view) -> Expected<void> {
         const auto time = time_of(v, at);
         if (!time) return std::unexpected(time.error());
         view.time_s = *time;
         return {};
       }},
  };
  auto view_of = [](const Json& v, const SuitePlace& at) -> Expected<BenchView> {
    Read view;
    if (auto read = read_keys(v, at, readers, view); !read) return std::unexpected(read.error());
    return BenchView{view.camera.camera, view.time_s};
  };
  return read_list(j, place, suite.views, view_of);
}

Expected<SuiteTechnique> technique_of(const Json& j, const SuitePlace& place) {
  if (j.is_string()) return SuiteTechnique{j.get<std::string>(), {}};
  static const Readers<SuiteTechnique> readers = {
      {"technique", [](const Json& v, const SuitePlace& at, SuiteTechnique& t) { return read_text(v, at, t.name); }},
      {"set", [](const Json& v, const SuitePlace& at, SuiteTechnique& t) { return read_sweeps(v, at, t.set); }},
  };
  SuiteTechnique technique;
  if (auto read = read_keys(j, place, readers, technique); !read) return std::unexpected(read.error());
  if (technique.name.empty()) return fail(ErrorKind::input, place.at + "/technique", "is missing");
  return technique;
}

Expected<void> read_frames(const Json& j, const SuitePlace& place, const FrameRate& rate, Suite& suite) {
  const auto text = text_of(j, place);
  if (!text) return std::unexpected(text.error());
  const auto frames = parse_frame_list(*text);
  if (!frames) return std::unexpected(Error{ErrorKind::input, frames.error().message, place.at});
  constexpr size_t most = 100'000;
  if (frames->size() > most)
    return fail(ErrorKind::input, place.at, "{} frames are more than the {} that a suite has", frames->size(), most);
  suite.times_s.clear();
  for (const int64_t frame : *frames) suite.times_s.push_back(rate.seconds(frame));
  return {};
}

Expected<void> read_max_lights(const Json& j, const SuitePlace& place, Suite& suite) {
  if (!j.is_object()) return place.wrong("is not an object of techniques");
  for (const auto& [technique, most] : j.items())
    if (auto read = read_whole(most, place.inside(technique), 0, suite.max_lights[technique]); !read) return read;
  return {};
}

template <class T, class Read>
auto list_into(std::vector<T> Suite::*member, Read read) {
  return [member, read](const Json& j, const SuitePlace& at, Suite& suite) {
    return read_list(j, at, suite.*member, read);
  };
}
auto text_into(std::string Suite::*member) {
  return [member](const Json& j, const SuitePlace& at, Suite& suite) { return read_text(j, at, suite.*member); };
}
auto count_into(int SamplingRules::*member, int lowest) {
  return [member, lowest](const Json& j, const SuitePlace& at, Suite& suite) {
    return read_whole(j, at, lowest, suite.sampling.*member);
  };
}
auto seconds_into(double SamplingRules::*member) {
  return [member](const Json& j, const SuitePlace& at, Suite& suite) {
    return read_positive(j, at, suite.sampling.*member);
  };
}

const Readers<Suite>& suite_readers() {
  static const Readers<Suite> table = {
      {"name", text_into(&Suite::name)},
      {"description", text_into(&Suite::description)},
      {"scenes", list_into(&Suite::scenes, scene_of)},
      {"lights", list_into(&Suite::lights, whole_of(0))},
      {"seed", [](const Json& j, const SuitePlace& at, Suite& s) { return read_whole(j, at, uint64_t(0), s.seed); }},
      {"techniques", list_into(&Suite::techniques, technique_of)},
      {"sizes", list_into(&Suite::sizes, size_of)},
      {"samples", list_into(&Suite::samples, whole_of(0))},
      {"set", [](const Json& j, const SuitePlace& at, Suite& s) { return read_sweeps(j, at, s.set); }},
      {"qualities", list_into(&Suite::qualities, text_of)},
      {"effects", list_into(&Suite::effects, text_of)},
      {"transparency", list_into(&Suite::transparency, text_of)},
      {"times", list_into(&Suite::times_s, time_of)},
      {"frames", [](const Json&, const SuitePlace&, Suite&) { return Expected<void>{}; }},  // with fps, below
      {"fps", [](const Json&, const SuitePlace&, Suite&) { return Expected<void>{}; }},
      {"views", [](const Json& j, const SuitePlace& at, Suite& s) { return read_views(j, at, s); }},
      {"output", text_into(&Suite::output)},
      {"reference", text_into(&Suite::reference)},
      {"max_lights", read_max_lights},
      {"reference_max_lights",
       [](const Json& j, const SuitePlace& at, Suite& s) { return read_whole(j, at, 0, s.reference_max_lights); }},
      {"precision", seconds_into(&SamplingRules::precision)},
      {"min_runs", count_into(&SamplingRules::min_runs, 1)},
      {"max_runs", count_into(&SamplingRules::max_runs, 1)},
      {"max_warm_up", count_into(&SamplingRules::max_warm_up, 1)},
      {"warm_up_s", seconds_into(&SamplingRules::warm_up_s)},
      {"max_sessions", count_into(&SamplingRules::max_sessions, 0)},
      {"budget_s", [](const Json& j, const SuitePlace& at, Suite& s) { return read_positive(j, at, s.budget_s); }},
  };
  return table;
}

}  // namespace

SuiteScene suite_scene(const std::string& text, const fs::path& folder, const fs::path& assets) {
  SuiteScene scene{.label = text};
  const auto generated = scene_names();
  if (std::find(generated.begin(), generated.end(), text) != generated.end()) return scene;
  if (text.starts_with(assets_prefix)) {
    std::error_code failed;
    scene.file = (assets / text.substr(assets_prefix.size())).string();
    if (!fs::is_directory(assets, failed))
      scene.missing = fmt::format("there is no folder of assets at {}", assets.string());
    return scene;
  }
  scene.file = (folder / text).lexically_normal().string();
  return scene;
}

Expected<Suite> suite_from_json(const std::string& text, const std::string& place, const fs::path& folder,
                                const fs::path& assets) {
  const auto parsed = read_json(text, place);
  if (!parsed) return std::unexpected(parsed.error());
  const Json& j = *parsed;
  if (!j.is_object()) return fail(ErrorKind::input, place, "is not a JSON object");
  const SuitePlace at{folder, assets, place + ": "};
  Suite suite;
  if (auto read = read_keys(j, at, suite_readers(), suite); !read) return std::unexpected(read.error());
  if (j.contains("frames") && j.contains("times"))
    return fail(ErrorKind::input, place + ": /frames", "moments are chosen either by frames or by times");
  if (j.contains("frames")) {
    const auto rate = parse_frame_rate(!j.contains("fps")     ? "24"
                                       : j["fps"].is_string() ? j["fps"].get<std::string>()
                                                              : j["fps"].dump());
    if (!rate) return std::unexpected(Error{ErrorKind::input, rate.error().message, place + ": /fps"});
    if (auto read = read_frames(j["frames"], at.inside("frames"), *rate, suite); !read)
      return std::unexpected(read.error());
  }
  if (suite.scenes.empty()) return fail(ErrorKind::input, place + ": /scenes", "is missing");
  return suite;
}

Expected<Suite> read_suite(const fs::path& file, const fs::path& assets) {
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  const std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  auto suite = suite_from_json(text, file.string(), file.parent_path(), assets);
  if (!suite) return suite;
  if (suite->name.empty()) suite->name = file.stem().string();
  // Names and values that no job takes stand in the file, not on the command line.
  if (const auto all = configurations(*suite); !all) {
    const std::string& place = all.error().place;
    return fail(all.error().kind, file.string() + ": " + (place.starts_with("--") ? place.substr(2) : place), "{}",
                all.error().message);
  }
  return suite;
}

}  // namespace candela
