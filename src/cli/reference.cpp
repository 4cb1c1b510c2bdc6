#include <tbb/global_control.h>
#include <tbb/info.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include "base/json.h"
#include "base/log.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/job_options.h"
#include "cli/output_paths.h"
#include "cli/result.h"
#include "cli/scene_notes.h"
#include "cli/signals.h"
#include "frame/job_look.h"
#include "frame/job_sky.h"
#include "frame/timings.h"
#include "reference/display.h"
#include "render/count_view.h"
#include "render/frame_names.h"
#include "render/reference_frame.h"
#include "render/reference_layers.h"

namespace candela::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct ReferenceOptions {
  JobOptions job;
  MomentOptions moment;
  std::vector<std::string> outputs;
  std::string mode = "direct", sampler = "sobol", bvh = "sah", visibility = "on", ambient = "traced", state;
  std::string layers = "variance", view = "beauty";
  uint64_t spp = 0;
  double seconds = 0, noise = 0, ambient_distance_m = 0;
  int bounces = 0, threads = 0;
  std::optional<int> fog_steps, fog_lights;
  bool resume = false;
};

struct ReferencePlan {
  Job job;
  Moment moment;
  reference::TraceSettings settings;
  AccelOptions accel;
  reference::Stop stop;
  std::vector<std::string> layers;
  std::vector<fs::path> paths;
};

template <class T>
Expected<T> choice(const char* option, const std::string& given,
                   const std::vector<std::pair<std::string, T>>& choices) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) {
    if (name == given) return value;
    names.push_back(name);
  }
  return fail(ErrorKind::usage, option, "{}", unknown_name("value", given, names));
}

Expected<void> read_settings(const ReferenceOptions& o, ReferencePlan& plan) {
  using namespace reference;
  const auto mode = choice<Mode>("--mode", o.mode, {{"direct", Mode::direct}, {"path", Mode::path}});
  if (!mode) return std::unexpected(mode.error());
  const auto sampler = choice<SamplerKind>(
      "--sampler", o.sampler,
      {{"sobol", SamplerKind::sobol}, {"jittered", SamplerKind::jittered}, {"uniform", SamplerKind::uniform}});
  if (!sampler) return std::unexpected(sampler.error());
  const auto bvh = choice<BvhBuilder>(
      "--bvh", o.bvh,
      {{"equal-counts", BvhBuilder::equal_counts}, {"sah", BvhBuilder::sah}, {"sbvh", BvhBuilder::sbvh}});
  if (!bvh) return std::unexpected(bvh.error());
  const auto visibility = choice<bool>("--visibility", o.visibility, {{"on", true}, {"off", false}});
  if (!visibility) return std::unexpected(visibility.error());
  const auto ambient = choice<Ambient>(
      "--ambient", o.ambient, {{"traced", Ambient::traced}, {"occlusion", Ambient::occlusion}, {"off", Ambient::off}});
  if (!ambient) return std::unexpected(ambient.error());
  const auto range = [](const char* option, double value) -> Expected<void> {
    if (!(value >= 0) || !std::isfinite(value))
      return fail(ErrorKind::usage, option, "{} is not a number of at least 0", value);
    return {};
  };
  for (const auto& [option, value] :
       {std::pair("--seconds", o.seconds), {"--noise", o.noise}, {"--ambient-distance", o.ambient_distance_m}})
    if (auto good = range(option, value); !good) return good;
  if (o.bounces < 0) return fail(ErrorKind::usage, "--bounces", "{} is below 0", o.bounces);
  if (o.threads < 0) return fail(ErrorKind::usage, "--threads", "{} is below 0", o.threads);
  if (o.spp > 1u << 30) return fail(ErrorKind::usage, "--spp", "{} is above {}", o.spp, 1u << 30);
  if (o.resume && o.state.empty())
    return fail(ErrorKind::usage, "--resume", "needs --state FILE, which an earlier run wrote");
  if (*mode == Mode::path)
    for (const auto& [option, given] : {std::pair("--visibility", !*visibility),
                                        {"--ambient", *ambient != Ambient::traced},
                                        {"--ambient-distance", o.ambient_distance_m > 0}})
      if (given) return fail(ErrorKind::usage, option, "belongs to --mode direct; path follows all light as it goes");
  if (*mode == Mode::direct && o.bounces > 0) return fail(ErrorKind::usage, "--bounces", "belongs to --mode path");
  for (const auto& [option, given, least, most] : {std::tuple("--fog-steps", o.fog_steps, 1, most_fog_steps),
                                                   {"--fog-lights", o.fog_lights, 0, most_fog_lights}}) {
    if (!given) continue;
    if (*mode == Mode::path)
      return fail(ErrorKind::usage, option, "belongs to --mode direct; path follows light through fog as it goes");
    if (plan.job.look.empty()) return fail(ErrorKind::usage, option, "needs --look FILE, which says what the fog is");
    if (*given < least || *given > most)
      return fail(ErrorKind::usage, option, "{} is outside {} to {}", *given, least, most);
  }
  constexpr uint64_t default_spp = 64;
  plan.stop = {o.spp, o.seconds, o.noise};
  if (o.spp == 0 && o.seconds == 0 && o.noise == 0) plan.stop.spp = default_spp;
  if (*sampler != SamplerKind::sobol && plan.stop.spp == 0)
    return fail(ErrorKind::usage, "--spp",
                "the sampler {} cuts the pixel into as many cells as there are samples: give their number", o.sampler);
  plan.settings.mode = *mode;
  plan.settings.sampler = {*sampler, int(std::max<uint64_t>(plan.stop.spp, 1)), plan.job.seed};
  plan.settings.visibility = *visibility;
  plan.settings.ambient = *ambient;
  if (o.ambient_distance_m > 0) plan.settings.ambient_distance_m = o.ambient_distance_m;
  plan.settings.most_bounces = o.bounces;
  if (plan.job.look.empty())
    plan.settings.fog_steps = 0;
  else if (o.fog_steps)
    plan.settings.fog_steps = *o.fog_steps;
  if (o.fog_lights) plan.settings.fog_lights = *o.fog_lights;
  plan.accel.builder = *bvh;
  return {};
}

Expected<void> read_outputs(const ReferenceOptions& o, ReferencePlan& plan) {
  if (o.outputs.empty()) return fail(ErrorKind::usage, "-o", "no output given; name a file that ends in .exr or .png");
  const std::vector<std::string> layers = reference_layer_names();
  std::vector<std::string> views = reference_view_names();
  views.insert(views.begin(), "beauty");
  if (!o.layers.empty() && o.layers != "none") plan.layers = split(o.layers, ',');
  for (const std::string& layer : plan.layers)
    if (std::find(layers.begin(), layers.end(), layer) == layers.end())
      return fail(ErrorKind::usage, "--layers", "{}", unknown_name("layer", layer, layers));
  if (std::find(views.begin(), views.end(), o.view) == views.end())
    return fail(ErrorKind::usage, "--view", "{}", unknown_name("view", o.view, views));
  auto paths = output_paths(o.outputs, plan.moment.frame.value_or(0));
  if (!paths) return std::unexpected(paths.error());
  plan.paths = std::move(*paths);
  for (const fs::path& path : plan.paths)
    if (auto ready = prepare_output(path); !ready) return ready;
  return o.state.empty() ? Expected<void>{} : prepare_output(o.state);
}

Expected<ReferencePlan> plan_reference(const ReferenceOptions& o) {
  ReferencePlan plan;
  const auto job = job_of(o.job);
  if (!job) return std::unexpected(job.error());
  const auto moment = moment_of(o.job, o.moment);
  if (!moment) return std::unexpected(moment.error());
  plan.job = *job, plan.moment = *moment;
  if (auto read = read_settings(o, plan); !read) return std::unexpected(read.error());
  if (auto read = read_outputs(o, plan); !read) return std::unexpected(read.error());
  return plan;
}

// One line on a terminal, a plain line every few seconds elsewhere.
class TraceProgress {
 public:
  explicit TraceProgress(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}
  ~TraceProgress() {
    if (open_) std::fputc('\n', stderr);
  }
  void show(const reference::Progress& p) {
    if (quiet_) return;
    const double step_s = terminal_ ? 0.1 : 5;
    if (p.seconds - last_s_ < step_s) return;
    last_s_ = p.seconds;
    std::string line =
        p.of_samples > 0 ? fmt::format("{}/{} spp", p.samples, p.of_samples) : fmt::format("{} spp", p.samples);
    line += fmt::format(", {:.0f} s", p.seconds);
    if (p.relative_error > 0) line += fmt::format(", noise {:.3g} %", p.relative_error * 100);
    const std::string whole = terminal_ ? "\r" + line + "\x1b[K" : line + "\n";
    std::fwrite(whole.data(), 1, whole.size(), stderr);
    open_ = terminal_;
  }

 private:
  bool quiet_, terminal_, open_ = false;
  double last_s_ = 0;
};

Expected<void> check_finite(const reference::Film& film, const Job& job) {
  size_t count = 0, first = 0;
  for (size_t i = 0; i < film.pixels(); ++i) {
    const glm::dvec4 m = film.mean(i);
    // As files hold it: what floats cannot hold is as bad as what doubles cannot.
    if (std::isfinite(float(m.x)) && std::isfinite(float(m.y)) && std::isfinite(float(m.z)) &&
        std::isfinite(float(m.w)))
      continue;
    if (count++ == 0) first = i;
  }
  if (count == 0 || job.allow_nonfinite) return {};
  return fail(ErrorKind::nonfinite, "",
              "{} pixels are not finite, the first at x {}, y {} of layer beauty; nothing was written", count,
              first % size_t(film.width()), first / size_t(film.width()));
}

Expected<void> write_images(const ReferencePlan& plan, const ReferenceOptions& o, const ReferenceFrame& frame,
                            const reference::Film& film) {
  if (auto finite = check_finite(film, plan.job); !finite) return finite;
  const std::string settings = settings_json(plan.settings, plan.accel);
  const uint64_t noise = plan.job.seed ^ std::bit_cast<uint64_t>(frame.time_s);
  for (const fs::path& path : plan.paths) {
    Expected<void> written;
    if (*output_format(path) == OutputFormat::exr) {
      written = write_exr(
          path, reference_image(film, frame, plan.job, settings, plan.layers, plan.moment.frame, plan.moment.rate),
          plan.job.exr_compression);
    } else {
      const DisplayLook look = display_look(plan.job, frame.look);
      reference::DisplaySettings display{.curve = look.curve,
                                         .exposure_ev = look.exposure_ev,
                                         .agx_min_ev = look.agx_min_ev,
                                         .agx_max_ev = look.agx_max_ev,
                                         .bits = plan.job.png_bits};
      if (frame.look.exposure.automatic) {
        std::vector<glm::dvec4> pixels;
        for (size_t i = 0; i < film.pixels(); ++i) pixels.push_back(film.mean(i));
        display.exposure_ev += reference::automatic_ev(pixels, *frame.look.exposure.automatic);
      }
      display.dither = plan.job.dither;
      display.alpha = plan.job.background == "transparent" && !has_sky(plan.job, frame.look);
      display.seed = uint32_t(noise ^ (noise >> 32));
      const DisplayImage image = o.view == "beauty" ? reference::display_image(film, display)
                                                    : count_view(reference_counts(film, frame, o.view), film.width(),
                                                                 film.height(), count_title(o.view));
      written = write_png(path, image, {{"candela:reference", settings}});
    }
    if (!written) return written;
    log::info("wrote {}", path.string());
  }
  return {};
}

Json result_json(const ReferencePlan& plan, const ReferenceFrame& frame, const reference::Film& film, double trace_s) {
  Json j;
  j["version"] = CANDELA_VERSION;
  j["job"] = own_json(job_json(plan.job));
  j["reference"] = own_json(settings_json(plan.settings, plan.accel));
  j["scene_content"] = frame.scene_content.hex();
  j["camera"] = frame.view.name;
  j["time_s"] = frame.time_s;
  j["look"] = look_json(plan.job, frame.look);
  j["notes"] = frame.notes;
  j["warnings"] = frame.warnings;
  j["spp"] = film.samples();
  const bool has_halves = film.samples() > 1;  // of one sample nothing is known
  j["mse"] = has_halves ? Json(film.mean_square_error()) : Json(nullptr);
  j["relative_error"] = has_halves ? Json(film.relative_error()) : Json(nullptr);
  j["trace_s"] = trace_s;
  const AccelStatistics& a = frame.world->accel().statistics();
  j["bvh"] = {{"triangles", a.triangles}, {"references", a.references}, {"nodes", a.nodes},
              {"instances", a.instances}, {"bytes", a.bytes},           {"sah_cost", a.sah_cost},
              {"build_ms", a.build_ms}};
  j["lights"] = {{"punctual", frame.world->punctual_lights().size()},
                 {"emissive_triangles", frame.world->emissive().size()}};
  j["outputs"] = Json::array();
  for (const fs::path& path : plan.paths) j["outputs"].push_back(path.string());
  return j;
}

// The film at the end of the run; the state file follows it.
struct Traced {
  reference::Film film;
  Expected<void> saved;  // the state file; a picture of hours is written all the same
};

Expected<Traced> trace(const ReferencePlan& plan, const ReferenceOptions& o, const ReferenceFrame& frame,
                       const std::atomic<int>& interrupted) {
  const reference::FilmParts parts = film_parts(frame, plan.layers);
  Hash128 identity = film_identity(plan.job, frame, plan.settings, plan.accel, parts.terms);
  if (parts.lamp_shadow) identity = hash128(identity.hex() + " shadow.lamps");
  reference::Film film(plan.job.width_px, plan.job.height_px, parts);
  std::error_code failed;
  if (o.resume && fs::exists(o.state, failed)) {
    auto loaded = reference::Film::load(o.state, identity, film.width(), film.height(), parts);
    if (!loaded) return std::unexpected(loaded.error());
    film = std::move(*loaded);
    log::info("goes on after {} samples a pixel", film.samples());
  }
  const reference::Integrator integrator(*frame.world, plan.settings, film.width(), film.height());
  TraceProgress progress(o.job.quiet);
  Expected<void> saved;
  constexpr double save_every_s = 60;
  double last_save_us = process_clock_us();
  const auto save = [&] {
    if (!o.state.empty()) {
      saved = film.save(o.state, identity);
      if (!saved) log::warning("{}: the samples so far are not kept", saved.error().text());
    }
    last_save_us = process_clock_us();
  };
  reference::refine(
      film, integrator, plan.stop,
      [&](const reference::Progress& p) {
        progress.show(p);
        return interrupted == 0;
      },
      [&] {
        if (process_clock_us() - last_save_us > save_every_s * 1e6) save();
      });
  save();
  return Traced{std::move(film), std::move(saved)};
}

Expected<int> run_reference(CLI::App& command, ReferenceOptions& o) {
  if (auto read = read_config(command, o.job.config); !read) return std::unexpected(read.error());
  set_log_level(o.job);
  const auto plan = plan_reference(o);
  if (!plan) return std::unexpected(plan.error());
  std::optional<tbb::global_control> threads;
  if (o.threads > 0) threads.emplace(tbb::global_control::max_allowed_parallelism, size_t(o.threads));
  const auto frame = open_reference(plan->job, plan->moment.time_s, plan->accel, plan->settings.mode);
  if (!frame) return std::unexpected(frame.error());
  if (auto noted = note_scene((*frame)->scene, o.job.strict); !noted) return std::unexpected(noted.error());
  log_look(plan->job, (*frame)->look);
  for (const std::string& note : (*frame)->notes) log::info("{}", note);
  for (const std::string& warning : (*frame)->warnings) log::warning("{}", warning);
  if (o.job.strict && !(*frame)->warnings.empty())
    return fail(ErrorKind::input, plan->job.scene, "--strict refuses the scene: {}", (*frame)->warnings.front());
  HeldSignals held;
  const double start_us = process_clock_us();
  const auto traced = trace(*plan, o, **frame, held.pending());
  if (!traced) return std::unexpected(traced.error());
  const reference::Film& film = traced->film;
  if (held.pending() != 0) {
    log::warning("interrupted after {} samples a pixel{}", film.samples(),
                 o.state.empty() || !traced->saved ? "" : "; --resume goes on from the state file");
    return 0;  // the signal ends the program
  }
  const double trace_s = (process_clock_us() - start_us) / 1e6;
  const std::string noise =
      film.samples() > 1 ? fmt::format(", relative standard error {:.3g} %", film.relative_error() * 100) : "";
  log::info("{} {} a pixel in {:.1f} s{}", film.samples(), film.samples() == 1 ? "sample" : "samples", trace_s, noise);
  if (auto written = write_images(*plan, o, **frame, film); !written) return std::unexpected(written.error());
  if (o.job.json)
    if (auto printed = print_json(result_json(*plan, **frame, film, trace_s)); !printed)
      return std::unexpected(printed.error());
  if (!traced->saved) return std::unexpected(traced->saved.error());
  return 0;
}

void add_trace_options(CLI::App& command, ReferenceOptions& o) {
  command.add_option("--mode", o.mode, "direct: light straight from its sources; path: all transport")
      ->capture_default_str()
      ->type_name("NAME");
  command.add_option("--spp", o.spp, "Samples a pixel; 64 where no limit is given")
      ->transform(whole_number<uint64_t>())
      ->type_name("N");
  command.add_option("--seconds", o.seconds, "Stop after this time; the number of samples then depends on the machine")
      ->type_name("S");
  command
      .add_option("--noise", o.noise,
                  "Stop when the relative standard error (of two halves of the samples, root mean square over the "
                  "pixels) is no larger; 0.01: 1 %")
      ->type_name("SHARE");
  command.add_option("--sampler", o.sampler, "sobol (Owen-scrambled), jittered, or uniform: a grid, x4, x8, x16")
      ->capture_default_str()
      ->type_name("NAME");
  command.add_option("--bvh", o.bvh, "How the acceleration structure is built: equal-counts, sah or sbvh")
      ->capture_default_str()
      ->type_name("NAME");
  command.add_option("--visibility", o.visibility, "direct: off lets light through everything")
      ->capture_default_str()
      ->type_name("on|off");
  command
      .add_option("--ambient", o.ambient,
                  "direct: the sky traced; its raster form times cosine-weighted occlusion; or off")
      ->capture_default_str()
      ->type_name("NAME");
  command
      .add_option("--ambient-distance", o.ambient_distance_m, "direct: farther surfaces do not hide the sky; 0: all do")
      ->capture_default_str()
      ->type_name("METRES");
  command.add_option("--bounces", o.bounces, "path: most bounces; 0: as Russian roulette decides")
      ->capture_default_str()
      ->type_name("N");
  command
      .add_option_function<int>(
          "--fog-steps", [&o](int value) { o.fog_steps = value; },
          fmt::format("direct: points on a ray at which a light's way through fog is followed, {} where nothing is "
                      "given; the mean is right for any",
                      reference::TraceSettings{}.fog_steps))
      ->type_name("N");
  command
      .add_option_function<int>(
          "--fog-lights", [&o](int value) { o.fog_lights = value; },
          fmt::format("direct: where more point lights and spots reach a ray through fog, they share the points of so "
                      "many, {} where nothing is given; 0: each has its own; the mean is right for any",
                      reference::TraceSettings{}.fog_lights))
      ->type_name("N");
  command.add_option("--threads", o.threads, "Threads; 0: all. Changes no byte")->capture_default_str()->type_name("N");
  command.add_option("--state", o.state, "Sums of the samples, written at the end and every minute")->type_name("FILE");
  command.add_flag("--resume", o.resume,
                   "Go on from --state where it exists; the image is that of a run without a break");
  command
      .add_option("--layers", o.layers,
                  fmt::format("EXR layers beside beauty: {}; or none", fmt::join(reference_layer_names(), ", ")))
      ->capture_default_str()
      ->type_name("LIST");
  command.add_option("--view", o.view, "What PNG shows: beauty, heatmap.traversal or heatmap.leaves")
      ->capture_default_str()
      ->type_name("NAME");
}

}  // namespace

void add_reference(CLI::App& app, Action& action) {
  auto o = std::make_shared<ReferenceOptions>();
  CLI::App* command = app.add_subcommand("reference", "Trace one frame on the CPU: what a render should look like");
  add_job_options(*command, o->job, Renderer::reference);
  add_moment_options(*command, o->moment);
  command->add_option("-o,--output", o->outputs, "File to write; the ending chooses EXR or PNG; may be given again")
      ->allow_extra_args(false)
      ->type_name("FILE");
  add_trace_options(*command, *o);
  add_run_options(*command, o->job, Renderer::reference);
  command->callback([command, o, &action] { action = [command, o] { return run_reference(*command, *o); }; });
}

}  // namespace candela::cli
