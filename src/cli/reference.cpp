#include <tbb/global_control.h>
#include <tbb/info.h>
#include <CLI/CLI.hpp>

#include "base/file_uses.h"
#include "base/json.h"
#include "base/log.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/job_options.h"
#include "cli/output_paths.h"
#include "cli/progress.h"
#include "cli/result.h"
#include "cli/scene_notes.h"
#include "cli/signals.h"
#include "cli/trace_options.h"
#include "render/frame_names.h"
#include "render/traced_frames.h"
#include "session/timings.h"

namespace candela::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct ReferenceOptions {
  JobOptions job;
  MomentOptions moment;
  TraceOptions tracing;
  std::vector<std::string> outputs;
  std::string layers = "variance", view = "beauty", state;
  bool resume = false;
};

struct ReferencePlan {
  Job job;
  Moment moment;
  TraceRequest request;
  std::vector<std::string> layers;
  std::vector<fs::path> paths;
};

Expected<void> read_outputs(const ReferenceOptions& o, ReferencePlan& plan) {
  if (o.outputs.empty()) return fail(ErrorKind::usage, "-o", "no output given; name a file that ends in .exr or .png");
  if (o.layers == all_layers)
    plan.layers = reference_layer_names();
  else if (!o.layers.empty() && o.layers != "none")
    plan.layers = split(o.layers, ',');
  if (auto good = check_traced_layers(plan.layers); !good) return good;
  if (auto good = check_compression(plan.layers, plan.job.exr_compression); !good) return good;
  if (auto good = check_traced_view(o.view, plan.job); !good) return good;
  auto paths = output_paths(o.outputs, plan.moment.frame.value_or(0));
  if (!paths) return std::unexpected(paths.error());
  plan.paths = std::move(*paths);
  std::vector<NamedFile> files;
  for (const fs::path& path : plan.paths) files.push_back({"-o", path});
  if (auto fine = declare_outputs(files); !fine) return fine;
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
  auto request = trace_request(o.tracing, plan.job);
  if (!request) return std::unexpected(request.error());
  plan.request = *request;
  if (o.resume && o.state.empty())
    return fail(ErrorKind::usage, "--resume", "needs --state FILE, which an earlier run wrote");
  if (auto read = read_outputs(o, plan); !read) return std::unexpected(read.error());
  return plan;
}

// Until the first limit; nullopt where nothing tells.
std::optional<double> seconds_left(const reference::Progress& p, const reference::Stop& stop) {
  std::optional<double> left;
  const auto limit = [&](double seconds) { left = std::max(0.0, left ? std::min(*left, seconds) : seconds); };
  const double samples = double(p.samples);
  if (stop.spp > 0 && p.samples > 0) limit(p.seconds * (double(stop.spp) / samples - 1));
  if (stop.seconds > 0) limit(stop.seconds - p.seconds);
  // Noise falls with the root of the number of samples.
  if (stop.noise > 0 && p.relative_error > 0) limit(p.seconds * (std::pow(p.relative_error / stop.noise, 2) - 1));
  return left;
}

void show_trace(StatusLine& status, const reference::Progress& p, const reference::Stop& stop) {
  if (p.samples == 0 || !status.due()) return;
  nlohmann::ordered_json members = {{"samples", p.samples}, {"seconds", p.seconds}};
  std::string line = fmt::format("{} spp", p.samples);
  if (p.of_samples > 0) {
    line = fmt::format("{}/{} spp", p.samples, p.of_samples);
    members["of_samples"] = p.of_samples;
  }
  line += fmt::format(", {:.0f} s", p.seconds);
  if (p.relative_error > 0) {
    line += fmt::format(", noise {:.3g} %", p.relative_error * 100);
    members["noise"] = p.relative_error;
  }
  if (const auto left = seconds_left(p, stop); left && p.seconds > 1) {
    line += fmt::format(", {:.0f} s left", *left);
    members["seconds_left"] = *left;
  }
  status.show(line, members);
}

Expected<void> write_images(const ReferencePlan& plan, const ReferenceOptions& o, const ReferenceFrame& frame,
                            const reference::Film& film) {
  if (auto finite = check_finite(film, plan.job); !finite) return finite;
  const std::string settings = settings_json(plan.request.settings, plan.request.accel);
  for (const fs::path& path : plan.paths) {
    Expected<void> written;
    if (*output_format(path) == OutputFormat::exr) {
      written = write_exr(path,
                          reference_image(film, frame, plan.job, settings, plan.layers, plan.moment.frame,
                                          plan.moment.rate, plan.request.settings.sampler),
                          plan.job.exr_compression);
    } else {
      const DisplayImage image = traced_display(film, frame, plan.job, o.view, plan.request.settings.sampler);
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
  j["reference"] = own_json(settings_json(plan.request.settings, plan.request.accel));
  j["scene_content"] = frame.scene_content().hex();
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
  j["bvh"] = {{"builder", name_of(a.builder)},
              {"triangles", a.triangles},
              {"references", a.references},
              {"binary_nodes", a.binary_nodes},
              {"nodes", a.nodes},
              {"instances", a.instances},
              {"bytes", a.bytes},
              {"sah_cost", a.sah_cost},
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
  fs::path state;        // that file; empty: there is none
};

Expected<Traced> trace(const ReferencePlan& plan, const ReferenceOptions& o, const ReferenceFrame& frame,
                       const std::atomic<int>& interrupted) {
  auto [film, identity, parts] = begin_film(plan.job, frame, plan.request, kept_layers(plan.layers, o.view));
  std::error_code failed;
  if (o.resume && fs::exists(o.state, failed)) {
    auto loaded = reference::Film::load(o.state, identity, film.width(), film.height(), parts);
    if (!loaded) return std::unexpected(loaded.error());
    loaded->place_in(film.picture(), film.corner());
    film = std::move(*loaded);
    log::info("continues after {} samples a pixel", film.samples());
  }
  auto moments = TracedMoments::open(frame, plan.job, plan.request);
  if (!moments) return std::unexpected(moments.error());
  StatusLine status(o.job.quiet);
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
      film, [&](uint64_t sample) { return moments->at(sample); }, plan.request.stop,
      [&](const reference::Progress& p) {
        show_trace(status, p, plan.request.stop);
        return interrupted == 0;
      },
      [&] {
        if (process_clock_us() - last_save_us > save_every_s * 1e6) save();
      });
  if (moments->error()) return std::unexpected(*moments->error());
  // An interruption keeps what was traced, asked for or not.
  fs::path state = o.state;
  if (interrupted != 0 && state.empty() && film.samples() > 0) {
    // Beside the picture, and in the place of no other film.
    const std::string picture = plan.paths.front().string();
    state = picture + ".film";
    for (int i = 2; fs::exists(state, failed); ++i) state = fmt::format("{}.{}.film", picture, i);
    saved = check_output(state);
    if (saved) saved = film.save(state, identity);
    if (!saved) log::warning("{}: the samples so far are not kept", saved.error().text());
  } else {
    save();
  }
  return Traced{std::move(film), std::move(saved), std::move(state)};
}

Expected<int> run_reference(CLI::App& command, ReferenceOptions& o) {
  if (auto read = read_config(command, o.job.config); !read) return std::unexpected(read.error());
  set_log_level(o.job);
  const auto plan = plan_reference(o);
  if (!plan) return std::unexpected(plan.error());
  std::optional<tbb::global_control> threads;
  if (o.tracing.threads > 0) threads.emplace(tbb::global_control::max_allowed_parallelism, size_t(o.tracing.threads));
  const auto frame = open_reference(plan->job, plan->moment.time_s, plan->request.accel, plan->request.settings.mode);
  if (!frame) return std::unexpected(frame.error());
  if (auto added = add_time_before(**frame, plan->job, kept_layers(plan->layers, o.view)); !added)
    return std::unexpected(added.error());
  if (auto noted = note_scene((*frame)->scene(), strictness(o.job.strict)); !noted)
    return std::unexpected(noted.error());
  log_look(plan->job, (*frame)->look);
  for (const std::string& note : (*frame)->notes) log::info("{}", note);
  for (const std::string& warning : (*frame)->warnings) log::warning("{}", warning);
  if (strictness(o.job.strict) == Strictness::all && !(*frame)->warnings.empty())
    return fail(ErrorKind::input, plan->job.scene, "--strict refuses the scene: {}", (*frame)->warnings.front());
  const bool any_png =
      std::ranges::any_of(plan->paths, [](const fs::path& path) { return *output_format(path) == OutputFormat::png; });
  if (auto fine = check_metering(plan->job, (*frame)->look, any_png); !fine) return std::unexpected(fine.error());
  HeldSignals held;
  const double start_us = process_clock_us();
  const auto traced = trace(*plan, o, **frame, held.pending());
  if (!traced) return std::unexpected(traced.error());
  const reference::Film& film = traced->film;
  if (held.pending() != 0) {
    log::warning("interrupted after {} samples a pixel{}", film.samples(),
                 traced->state.empty() || !traced->saved
                     ? ""
                     : fmt::format("; the same command with --state {} --resume goes on", traced->state.string()));
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

void add_own_options(CLI::App& command, ReferenceOptions& o) {
  command
      .add_option("--seconds", o.tracing.seconds,
                  "Stop after this time; the number of samples then depends on the machine")
      ->type_name("S");
  command
      .add_option("--state", o.state, "File that keeps the samples, written at the end and every minute, for --resume")
      ->type_name("FILE");
  command.add_flag("--resume", o.resume,
                   "Continue from --state if it exists; the picture is that of an uninterrupted run");
  command
      .add_option(
          "--layers", o.layers,
          fmt::format("EXR layers beside beauty: {}; or all, or none", fmt::join(reference_layer_names(), ", ")))
      ->capture_default_str()
      ->type_name("LIST");
  std::vector<std::string_view> knobs;
  for (const TreeKnob& knob : tree_knobs()) knobs.push_back(knob.name);
  command
      .add_option(
          "--set", o.tracing.settings,
          fmt::format(
              "How the acceleration structure is built (docs/understanding/reference.md): {}; may be given again",
              fmt::join(knobs, ", ")))
      ->allow_extra_args(false)
      ->type_name("bvh.NAME=VALUE");
  command.add_option("--view", o.view, "What PNG shows: beauty or any layer")->capture_default_str()->type_name("NAME");
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
  add_trace_options(*command, o->tracing);
  add_own_options(*command, *o);
  add_run_options(*command, o->job, Renderer::reference);
  command->callback([command, o, &action] { action = [command, o] { return run_reference(*command, *o); }; });
}

}  // namespace candela::cli
