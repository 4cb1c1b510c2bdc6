#include "cli/job_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "base/files.h"
#include "base/log.h"
#include "base/log_form.h"
#include "base/text.h"
#include "cli/file_options.h"
#include "cli/input_options.h"
#include "cli/picture_options.h"
#include "cli/shutter_options.h"
#include "job/frame_choices.h"
#include "job/old_names.h"
#include "look/look.h"
#include "plan/posed_scene.h"
#include "render/metering.h"
#include "scene/up_axis.h"

namespace candela::cli {

namespace {

constexpr std::string_view auto_exposure = "auto";  // --exposure

void add_technique_options(CLI::App& command, JobOptions& o) {
  command
      .add_option("--samples", o.samples,
                  "Samples a pixel: 1, 2, 4 or 8, as the device has them; 0: as the quality says")
      ->capture_default_str()
      ->type_name("N");
  command
      .add_option("--technique", o.technique,
                  "How the frame is made (candela list techniques); auto: the quickest on the device")
      ->capture_default_str()
      ->type_name("NAME");
  command
      .add_option("--transparency", o.transparency,
                  "How blended surfaces in front of each other are drawn (candela list transparency); auto: exactly "
                  "(layers) if the device can, else by moments")
      ->capture_default_str()
      ->type_name("NAME");
  command
      .add_option("--set", o.settings,
                  "Set one knob, instead of the quality's value (candela list knobs); may be given again")
      ->allow_extra_args(false)
      ->type_name("PASS.KNOB=VALUE");
}

void add_window_options(CLI::App& command, JobOptions& o) {
  command
      .add_option("--region", o.region,
                  "Render only this part of the picture, in pixels from its upper left corner; its pixels are those of "
                  "the whole picture (docs/using/outputs.md)")
      ->type_name("X,Y,W,H");
  command
      .add_option("--overscan", o.overscan,
                  "Render beyond the picture on each side, by pixels or by a percentage of width and height")
      ->type_name("PX|P%");
  command
      .add_option("--light-groups", o.light_groups,
                  "Write the light of the lights at these nodes to the EXR layer light_NAME, that of all others to "
                  "light_rest; * stands for any letters; may be given again")
      ->allow_extra_args(false)
      ->type_name("NAME=NODE,...");
}

void add_effect_options(CLI::App& command, JobOptions& o) {
  command
      .add_option("--quality", o.quality,
                  "Preset of all knobs: draft, normal, high or exact (on a CPU candela reference gives the exact "
                  "picture sooner)")
      ->capture_default_str()
      ->type_name("NAME");
  command
      .add_option("--effects", o.effects,
                  "auto (lighting effects by quality, others by the look file), none, or names separated by commas "
                  "(docs/understanding/effects.md)")
      ->capture_default_str()
      ->type_name("LIST");
}

// How the picture comes out, of a frame that is otherwise the same.
}  // namespace

namespace {
void add_motion_options(CLI::App& command, JobOptions& o) {
  command
      .add_option("--camera-path", o.camera_path,
                  "Move the camera along a B-spline through the points of a file: FILE[,times=FILE][,closed]... "
                  "(docs/using/paths.md)")
      ->type_name("FILE,...");
  command
      .add_option("--path", o.paths,
                  "Move a node (by name, or 'light NAME') along a path: NODE=FILE[,times=FILE]...; may be given again")
      ->allow_extra_args(false)
      ->type_name("NODE=FILE,...");
  command
      .add_option("--instances", o.instances,
                  "Draw a node's mesh at each place that a file lists: "
                  "NODE=FILE[,rotation=zyx][,units=radians][,order=trs]; may be given again")
      ->allow_extra_args(false)
      ->type_name("NODE=FILE,...");
}
}  // namespace

void add_job_options(CLI::App& command, JobOptions& o, Renderer renderer) {
  command.add_option("scene", o.scene, "glTF file, .gltf or .glb")->type_name("SCENE");
  command
      .add_option(
          "--up", o.up,
          "Axis of the file that points up: y (glTF's), z or x; --eye and --target are given in the file's own axes")
      ->capture_default_str()
      ->type_name("AXIS");
  command.add_option("--fps", o.fps, "Frames per second: 24, 23.976, 30000/1001")
      ->capture_default_str()
      ->type_name("RATE");
  command
      .add_option("--animation", o.animation,
                  "Animations to play: a name, an index, all, none, or auto: all except those that move what an "
                  "earlier one moves")
      ->capture_default_str()
      ->type_name("NAME");
  command
      .add_option("--camera", o.camera,
                  "Camera of the scene, by name or index; by default the first, or one that shows everything if the "
                  "file has none; render also takes all: a picture from each")
      ->type_name("NAME");
  command.add_option("--eye", o.eye, "Camera position, metres; goes with --target")->type_name("X,Y,Z");
  command.add_option("--target", o.target, "Point that the camera looks at, metres")->type_name("X,Y,Z");
  command.add_option("--yfov", o.yfov_deg, "Vertical field of view")->type_name("DEGREES");
  command
      .add_option(
          "--azimuth", o.azimuth_deg,
          "Look at the whole scene from so many degrees to the right of its front; 30 if only --elevation is given")
      ->type_name("DEGREES");
  command
      .add_option("--elevation", o.elevation_deg,
                  "Look at the whole scene from so many degrees above; 20 if only --azimuth is given")
      ->type_name("DEGREES");
  command.add_flag(
      "--fit", o.fit,
      "Move the camera until what is drawn fills the picture; it keeps its direction, and one place for a whole film");
  command.add_flag("--follow", o.follow,
                   "Place the automatic camera anew for each frame, so that it follows what moves");
  command
      .add_option("--turntable", o.turntable,
                  "Turn the camera once around the scene in N frames, beginning at --azimuth; --animation none keeps "
                  "everything else still")
      ->check(CLI::Range(1, 1000000))
      ->type_name("N");
  if (renderer != Renderer::none) add_shutter_options(command, o);
  add_motion_options(command, o);
  command.add_option("--size", o.size, "Size of the image in pixels, or 720p, 1080p, 1440p, 4k or 8k")
      ->capture_default_str()
      ->type_name("WxH");
  if (renderer != Renderer::none) add_window_options(command, o);
  if (renderer == Renderer::gpu) add_technique_options(command, o);
  if (renderer != Renderer::reference) add_effect_options(command, o);
  command
      .add_option("--sky", o.sky,
                  "Equirectangular .hdr or .exr, or six faces (a folder, or a path with *), which lights the scene and "
                  "fills the background; studio: soft boxes, not seen in the background; neutral: even light; "
                  "atmosphere: a day sky with the scene's sun; auto: the look's sky, or the studio if the file has no "
                  "light either; none: only the scene's own light")
      ->capture_default_str()
      ->type_name("FILE");
  command
      .add_option(
          "--look", o.look,
          "Look file (docs/using/look.md); by default NAME.look.json beside the scene, if it is there; none: no look")
      ->type_name("FILE");
  if (renderer != Renderer::none)
    command
        .add_option("--sides", o.sides,
                    "Whether light comes through single-sided faces from behind: block stops it, open lets it through, "
                    "auto is open if the camera looks through many such faces")
        ->capture_default_str()
        ->type_name("auto|block|open");
  command
      .add_option("--cut-outs", o.cut_outs,
                  "Blended materials whose alpha is all or nothing (candela facts): blended, or masked")
      ->capture_default_str()
      ->type_name("NAME");
  command
      .add_option("--variant", o.variant, "Variant of the file's materials, by name; without one the default materials")
      ->type_name("NAME");
  command
      .add_option("--probe", o.probe,
                  "A sphere in the middle of the view, a quarter of the picture's height: white, grey (18 %) or chrome")
      ->type_name("NAME");
  if (renderer != Renderer::none) add_picture_options(command, o, renderer);
  add_input_options(command);
}

namespace {
void add_device_options(CLI::App& command, JobOptions& o) {
  command
      .add_option("--device", o.device,
                  "cpu, gpu, an index, a UUID or part of a name (candela list devices); the best GPU by default")
      ->type_name("DEVICE");
  command.add_flag("--allow-cpu", o.allow_cpu,
                   "Use the CPU without a warning if there is no GPU; on farms too, even if the job was made on a "
                   "machine with a GPU");
  command.add_flag("--validate", o.validate,
                   "Run with the Khronos validation layer and synchronization checks; any message is exit 4");
  command.add_option("--shader-dir", o.shader_folder, "Shaders from this folder instead of the built-in ones")
      ->type_name("DIR");
  command.add_option("--timeout", o.timeout_s, "Longest wait for one frame")
      ->capture_default_str()
      ->type_name("SECONDS");
  command
      .add_option("--queues", o.queues, "1: all passes on one queue, even if the device has a second one for compute")
      ->check(CLI::Range(1, 2))
      ->capture_default_str()
      ->type_name("N");
}
}  // namespace

void add_strict_option(CLI::App& command, JobOptions& o) {
  command
      .add_flag("--strict{all}", o.strict,
                "Exit 3 on a warning about the scene, an ignored extension, or a frame in which nothing is drawn; "
                "--strict=loss: only if a texture, a surface or a light is lost")
      ->check(CLI::IsMember({"all", "loss"}));
}

void add_run_options(CLI::App& command, JobOptions& o, Renderer renderer) {
  if (renderer == Renderer::gpu) add_device_options(command, o);
  add_strict_option(command, o);
  if (renderer == Renderer::gpu)
    command.add_flag("--allow-blank", o.allow_blank, "Let a frame in which nothing is drawn pass --strict");
  command.add_option("--config", o.config, "Options from an INI or TOML file; the command line overrides it")
      ->type_name("FILE");
  command.add_flag("--quiet", o.quiet, "Only warnings and errors on stderr");
  command.add_flag("--verbose", o.verbose, "More on stderr");
  // At once: an error in another option is a line too.
  command
      .add_option_function<std::string>(
          "--log", [](const std::string& form) { log::set_form(form == "json" ? log::Form::json : log::Form::text); },
          "stderr as text, or as a JSON object a line")
      ->check(CLI::IsMember({"text", "json"}))
      ->type_name("FORM")
      ->default_str("text");
  command.add_flag("--json", o.json, "The result as JSON on stdout");
}

namespace {
CLI::Validator number_from(bool zero) {
  const auto check = [zero](std::string& text) -> std::string {
    double value = 0;
    const char* end = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data(), end, value);
    if (error == std::errc{} && at == end && std::isfinite(value) && (value > 0 || (zero && value == 0))) return {};
    return fmt::format("'{}' is not a number {}", text, zero ? "of at least 0" : "above 0");
  };
  return {check, ""};
}
}  // namespace

CLI::Validator positive_number() { return number_from(false); }
CLI::Validator non_negative_number() { return number_from(true); }

Expected<void> read_config(CLI::App& command, const std::string& file) {
  if (file.empty()) return {};
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  std::vector<CLI::ConfigItem> items;
  try {
    std::istringstream stream(std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()));
    items = CLI::ConfigTOML().from_config(stream);
  } catch (const CLI::Error& error) {
    return fail(ErrorKind::input, file, "cannot be read as INI or TOML: {}", error.what());
  }
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    if (option->get_configurable()) names.push_back(option->get_single_name());
  for (const CLI::ConfigItem& item : items) {
    // A section may carry the command's name, so that one file serves several commands.
    if (item.name == "++" || item.name == "--") continue;
    if (!item.parents.empty() && item.parents != std::vector<std::string>{command.get_name()}) continue;
    CLI::Option* option = nullptr;
    for (CLI::Option* candidate : command.get_options())
      if (candidate->get_single_name() == item.name) option = candidate;
    // What is no matter of `facts` may stand in a file for several commands.
    if (!option && command.get_name() == "facts" &&
        command.get_parent()->get_subcommand("render")->get_option_no_throw("--" + item.name))
      continue;
    if (!option || item.name == "help" || item.name == "config")
      return fail(ErrorKind::input, file, "{}", unknown_name("option", item.name, names));
    if (option->count() > 0) continue;
    try {
      if (option->get_expected_min() == 0)
        option->add_result(option->get_flag_value(item.name, item.inputs.empty() ? "true" : item.inputs.front()));
      // An unquoted list such as 1,2,3 arrives in pieces; options that take one text want it whole.
      else if (option->get_expected_max() == 1)
        option->add_result(joined(item.inputs, ","));
      else
        option->add_result(item.inputs);
      option->run_callback();
    } catch (const CLI::Error& error) {
      return fail(ErrorKind::input, file, "{}: {}", item.name, error.what());
    }
  }
  return check_file_options(command);
}

namespace {

Expected<std::optional<glm::dvec3>> parse_point(const char* option, const std::string& text) {
  if (text.empty()) return std::optional<glm::dvec3>{};
  const std::vector<std::string> parts = split(text, ',');
  glm::dvec3 point{0};
  bool good = parts.size() == 3;
  for (int i = 0; good && i < 3; ++i) {
    const char *begin = parts[size_t(i)].data(), *end = begin + parts[size_t(i)].size();
    const auto read = std::from_chars(begin, end, point[i]);
    good = read.ec == std::errc{} && read.ptr == end && std::isfinite(point[i]);
  }
  if (!good) return fail(ErrorKind::usage, option, "'{}' is not a point; write X,Y,Z in metres", text);
  return std::optional<glm::dvec3>{point};
}

Expected<void> read_motion(const JobOptions& o, Job& job) {
  const auto add = [](auto parsed, auto& to) -> Expected<void> {
    if (!parsed) return std::unexpected(parsed.error());
    to.push_back(std::move(*parsed));
    return {};
  };
  if (!o.camera_path.empty())
    if (auto read = add(parse_path("--camera-path", "camera", o.camera_path), job.paths); !read) return read;
  for (const std::string& text : o.paths)
    if (auto read = add(parse_node_path("--path", text), job.paths); !read) return read;
  for (const std::string& text : o.instances)
    if (auto read = add(parse_instances("--instances", text), job.instances); !read) return read;
  return {};
}

Expected<void> read_texts(const JobOptions& o, Job& job) {
  const auto size = parse_size(o.size);
  if (!size) return std::unexpected(Error{ErrorKind::usage, size.error().message, "--size"});
  std::tie(job.width_px, job.height_px) = *size;
  if (!o.region.empty()) {
    const auto region = parse_pixel_rect(o.region);
    if (!region) return std::unexpected(Error{ErrorKind::usage, region.error().message, "--region"});
    job.region = *region;
  }
  if (!o.overscan.empty()) {
    const auto overscan = parse_overscan(o.overscan);
    if (!overscan) return std::unexpected(Error{ErrorKind::usage, overscan.error().message, "--overscan"});
    job.overscan = *overscan;
  }
  for (const std::string& text : o.light_groups) {
    const auto group = parse_light_group(text);
    if (!group) return std::unexpected(Error{ErrorKind::usage, group.error().message, "--light-groups"});
    job.light_groups.push_back(*group);
  }
  const auto eye = parse_point("--eye", o.eye), target = parse_point("--target", o.target);
  if (!eye) return std::unexpected(eye.error());
  if (!target) return std::unexpected(target.error());
  const glm::dmat3 turned = world_from_file(o.up);
  if (*eye) job.camera.eye = turned * **eye;
  if (*target) job.camera.target = turned * **target;
  for (const std::string& text : o.settings) {
    const auto setting = parse_knob_setting(text);
    if (!setting) return std::unexpected(Error{ErrorKind::usage, setting.error().message, "--set"});
    job.settings.push_back(*setting);
  }
  if (o.exr_type != "half" && o.exr_type != "float")
    return fail(ErrorKind::usage, "--exr-type", "'{}' is neither half nor float", o.exr_type);
  job.exr_float = o.exr_type == "float";
  const auto compression = exr_compression_from_name(o.exr_compression);
  if (!compression) return fail(ErrorKind::usage, "--exr-compression", "{}", compression.error().message);
  job.exr_compression = *compression;
  return {};
}

}  // namespace

namespace {

// Absent for "auto", which is metered once the rest of the job is known.
Expected<std::optional<float>> exposure_of(const std::string& text) {
  if (text.empty() || text == auto_exposure) return std::optional<float>();
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    return fail(ErrorKind::usage, "--exposure", "'{}' is not a number of stops; write -1.5, or auto", text);
  return std::optional(value);
}

}  // namespace

Expected<Job> job_of(const JobOptions& o) {
  if (o.scene.empty()) return fail(ErrorKind::usage, "SCENE", "no scene given; name a .gltf or .glb file");
  Job job;
  job.scene = o.scene;
  job.up = o.up;
  job.animation = o.animation;
  job.camera.camera = o.camera;
  job.camera.yfov_deg = o.yfov_deg;
  job.camera.azimuth_deg = o.azimuth_deg, job.camera.elevation_deg = o.elevation_deg;
  job.camera.fit = o.fit;
  const bool places_itself = o.fit || (o.eye.empty() && o.camera.empty());
  if (o.follow && !places_itself)
    return fail(ErrorKind::usage, "--follow",
                "goes with cameras that place themselves: leave out --eye and --camera, or add --fit");
  if (places_itself) job.camera.framing = o.follow ? Framing::follow : Framing::film;
  const auto rate = parse_frame_rate(o.fps);
  if (!rate) return std::unexpected(Error{ErrorKind::usage, rate.error().message, "--fps"});
  job.motion_s = rate->seconds(1);
  if (o.turntable > 0) job.camera.turn_s = rate->seconds(o.turntable);
  if (auto read = read_shutter(o, job); !read) return std::unexpected(read.error());
  job.samples = o.samples;
  job.technique = o.technique;
  job.transparency = o.transparency;
  job.sides = o.sides;
  job.quality = o.quality;
  job.effects = o.effects;
  job.sky = o.sky;
  job.look = o.look == "none" ? "" : o.look.empty() ? look_beside(o.scene).string() : o.look;
  job.shading = o.shading;
  job.variant = o.variant, job.cut_outs = o.cut_outs;
  job.probe = o.probe;
  const auto exposure = exposure_of(o.exposure);
  if (!exposure) return std::unexpected(exposure.error());
  job.exposure_ev = *exposure;
  job.tonemap = o.tonemap;
  job.view = o.view;
  if (!o.layers.empty()) job.layers = split(o.layers, ',');
  take_new_names(job);
  if (std::ranges::find(job.layers, all_layers) != job.layers.end()) {
    job.layers = layer_names();
    job.layers.insert(job.layers.begin(), std::string(all_layers));
  }
  job.background = o.background;
  job.seed = o.seed;
  job.png_bits = o.png_bits;
  job.dither = !o.no_dither;
  job.timings_in_metadata = o.metadata_timings;
  job.allow_nonfinite = o.allow_nonfinite;
  if (auto read = read_texts(o, job); !read) return std::unexpected(read.error());
  if (auto read = read_motion(o, job); !read) return std::unexpected(read.error());
  if (auto checked = check_job(job); !checked) return std::unexpected(checked.error());
  if (o.exposure != auto_exposure) return job;
  const auto ev = metered_ev(job);
  if (!ev) return std::unexpected(ev.error());
  job.exposure_ev = float(*ev);
  log::info("exposure auto: {:+.2f} stops for all frames (--exposure)", *ev);
  return job;
}

Expected<RunSettings> run_settings_of(const JobOptions& o) {
  if (!(o.timeout_s > 0))
    return fail(ErrorKind::usage, "--timeout", "{} s is not a time to wait; give more than 0", o.timeout_s);
  std::error_code failed;
  if (!o.shader_folder.empty() && !std::filesystem::is_directory(o.shader_folder, failed))
    return fail(ErrorKind::usage, "--shader-dir", "'{}' is not a folder", o.shader_folder);
  RunSettings settings;
  settings.device = o.device;
  settings.validate = o.validate;
  settings.shader_folder = o.shader_folder;
  settings.timeout_s = o.timeout_s;
  settings.queues = o.queues;
  return settings;
}

void set_log_level(const JobOptions& o) {
  log::set_level(o.quiet ? log::Level::warning : o.verbose ? log::Level::debug : log::Level::info);
}

}  // namespace candela::cli
