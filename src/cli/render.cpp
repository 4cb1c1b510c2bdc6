#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/file_uses.h"
#include "base/log.h"
#include "base/log_gather.h"
#include "base/names.h"
#include "base/text.h"
#include "cli/budget.h"
#include "cli/command.h"
#include "cli/job_options.h"
#include "cli/output_paths.h"
#include "cli/progress.h"
#include "cli/render_steps.h"
#include "cli/result.h"
#include "cli/scene_notes.h"
#include "cli/signals.h"
#include "render/dump.h"
#include "render/frame_names.h"
#include "render/outputs.h"
#include "session/timings.h"

namespace candela::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct RenderOptions {
  JobOptions job;
  MomentOptions moment;
  BudgetOptions budget;
  std::string frames;
  std::vector<std::string> outputs, dumps;
  std::string timings, trace, steps;
  bool overlap = false;
  std::optional<int> check_determinism;  // number of runs
};

// One picture of a call: a camera at a moment.
struct Shot {
  Moment moment;
  std::string camera;       // index; empty: the job's own
  std::string camera_name;  // for {camera} in file names
  std::vector<fs::path> paths;
};

struct RenderPlan {
  Job job;
  WantedOutputs wanted;
  std::vector<Moment> moments;
  bool all_cameras = false;  // then the shots are known when the scene is
  std::vector<Shot> shots;
  std::vector<fs::path> dump_paths;
};

// PASS.IMAGE[mip,layer]=FILE; without a file the name stands beside the first output: "out.resolve.resolved.exr".
Expected<void> plan_dumps(const RenderOptions& o, RenderPlan& plan) {
  if (o.dumps.empty()) return {};
  std::vector<std::string> files = o.outputs;
  for (const std::string& text : o.dumps) {
    const size_t equals = text.find('=');
    const auto request = parse_dump(text.substr(0, equals));
    if (!request) return std::unexpected(request.error());
    plan.wanted.dumps.push_back(*request);
    if (equals != std::string::npos) {
      files.push_back(text.substr(equals + 1));
    } else if (o.outputs.empty()) {
      return fail(ErrorKind::usage, "--dump", "'{}' needs a file without -o: {}=FILE.exr", text, text);
    } else {
      const std::string part =
          request->mip || request->layer ? fmt::format(".mip{}.layer{}", request->mip, request->layer) : "";
      const fs::path beside = fs::path(o.outputs.front()).replace_extension("");
      files.push_back(fmt::format("{}.{}{}.exr", beside.string(), request->name, part));
    }
    const auto format = output_format(files.back());
    if (!format || *format != OutputFormat::exr)
      return fail(ErrorKind::usage, "--dump", "'{}' does not end in .exr", files.back());
  }
  auto all = output_paths(files, plan.moments.front().frame.value_or(0));
  if (!all) return std::unexpected(all.error());
  plan.dump_paths.assign(all->begin() + long(o.outputs.size()), all->end());
  std::vector<NamedFile> named;
  for (const fs::path& path : plan.dump_paths) named.push_back({"--dump", path});
  if (auto fine = declare_outputs(named); !fine) return fine;
  for (const fs::path& path : plan.dump_paths)
    if (auto ready = prepare_output(path); !ready) return ready;
  return {};
}

Expected<std::vector<Moment>> moments_of(const RenderOptions& o) {
  if (o.frames.empty()) {
    const auto moment = moment_of(o.job, o.moment);
    if (!moment) return std::unexpected(moment.error());
    return std::vector{*moment};
  }
  if (o.moment.frame_option->count() > 0 || o.moment.time_option->count() > 0)
    return fail(ErrorKind::usage, "--frames", "does not go with --frame and --time");
  const auto frames = parse_frame_list(o.frames);
  if (!frames) return std::unexpected(Error{ErrorKind::usage, frames.error().message, "--frames"});
  const auto rate = parse_frame_rate(o.job.fps);
  if (!rate) return std::unexpected(Error{ErrorKind::usage, rate.error().message, "--fps"});
  constexpr size_t most = 100'000;
  if (frames->size() > most)
    return fail(ErrorKind::usage, "--frames", "{} frames are more than the {} that render makes; use candela sequence",
                frames->size(), most);
  std::vector<Moment> moments;
  for (const int64_t frame : *frames) moments.push_back({frame, *rate, rate->seconds(frame)});
  return moments;
}

// Fills the paths in, which must differ, and makes sure that they can be written.
Expected<void> name_shots(const RenderOptions& o, std::vector<Shot>& shots) {
  std::set<fs::path> seen;
  std::vector<NamedFile> files;
  for (Shot& shot : shots) {
    auto paths = output_paths(o.outputs, shot.moment.frame.value_or(0), shot.camera_name);
    if (!paths) return std::unexpected(paths.error());
    shot.paths = std::move(*paths);
    for (const fs::path& path : shot.paths) {
      if (!seen.insert(path).second)
        return fail(ErrorKind::usage, "-o", "'{}' would hold several pictures; write {}", path.string(),
                    shot.camera.empty() ? "#### where the frame number goes"
                                        : "{camera} where the camera's name goes, and #### for the frame number");
      files.push_back({"-o", path});
    }
  }
  if (auto fine = declare_outputs(files); !fine) return fine;
  for (const NamedFile& output : files)
    if (auto ready = prepare_output(output.file); !ready) return ready;
  return {};
}

// Every camera that a node carries, by name; without one by index. Names that files cannot have, or that several
// cameras have, are changed so that each camera has a file of its own.
std::vector<Shot> shots_of_cameras(const Scene& scene, const std::vector<Moment>& moments) {
  std::set<int> cameras;
  for (const int node : scene.order)
    if (scene.nodes[size_t(node)].camera >= 0) cameras.insert(scene.nodes[size_t(node)].camera);
  std::vector<std::string> names;
  for (const int camera : cameras) {
    const std::string& name = scene.cameras[size_t(camera)].name;
    names.push_back(name.empty() ? fmt::format("camera{}", camera) : name);
  }
  names = file_name_parts(names);
  std::vector<Shot> shots;
  size_t name = 0;
  for (const int camera : cameras) {
    for (const Moment& moment : moments) shots.push_back({moment, std::to_string(camera), names[name]});
    ++name;
  }
  return shots;
}

Expected<void> check_one_shot(const RenderOptions& o, const RenderPlan& plan) {
  if (plan.moments.size() == 1 && !plan.all_cameras) return {};
  const char* several = plan.all_cameras ? "--camera" : "--frames";
  for (const auto& [option, given] : {std::pair("--timings", !o.timings.empty()),
                                      {"--trace", !o.trace.empty()},
                                      {"--dump", !o.dumps.empty()},
                                      {"--steps", !o.steps.empty()},
                                      {"--check-determinism", bool(o.check_determinism)}})
    if (given) return fail(ErrorKind::usage, option, "is of one picture; it does not go with several ({})", several);
  if (plan.all_cameras && (plan.job.camera.eye || plan.job.camera.azimuth_deg || plan.job.camera.elevation_deg ||
                           plan.job.camera.turn_s > 0))
    return fail(ErrorKind::usage, "--camera", "all does not go with options that place the camera");
  return {};
}

Expected<RenderPlan> plan_render(const CLI::App& command, RenderOptions& o) {
  RenderPlan plan;
  JobOptions options = o.job;
  plan.all_cameras = options.camera == "all";
  if (plan.all_cameras) options.camera.clear();
  auto job = job_of(options);
  if (!job) return std::unexpected(job.error());
  const auto frames = with_all_frames(o.frames, *job, options.fps);
  if (!frames) return std::unexpected(frames.error());
  o.frames = *frames;
  const auto chosen = choice_within(command, o.budget, *job, o.job.device);
  if (!chosen) return std::unexpected(chosen.error());
  if (const auto& choice = *chosen) {
    job->technique = choice->technique, job->quality = choice->quality;
    job->settings = choice->settings, job->samples = choice->samples;
    if (auto fine = check_job(*job); !fine) return std::unexpected(fine.error());
    log::info("chosen: {}; measured {:.3g} ms (95 % CI {:.3g} to {:.3g}), error {:.3g} ({:.3g} to {:.3g})",
              choice->text, choice->ms, choice->ms_ci.low, choice->ms_ci.high, choice->error, choice->error_ci.low,
              choice->error_ci.high);
  }
  for (const auto& [option, given] : {std::pair("--dump", !o.dumps.empty()),
                                      {"--check-determinism", bool(o.check_determinism)},
                                      {"--view", bool(image_of_view(job->view))}})
    if (job->region && given)
      return fail(ErrorKind::usage, option, "looks at whole images of a frame, of which --region leaves parts empty");
  auto moments = moments_of(o);
  if (!moments) return std::unexpected(moments.error());
  plan.job = *job;
  plan.moments = std::move(*moments);
  if (o.outputs.empty() && o.dumps.empty() && o.steps.empty() && !o.check_determinism)
    return fail(ErrorKind::usage, "-o", "no output given; name a file that ends in .exr or .png");
  if (o.check_determinism && *o.check_determinism < 2)
    return fail(ErrorKind::usage, "--check-determinism", "takes at least 2 runs");
  if (auto good = check_one_shot(o, plan); !good) return std::unexpected(good.error());
  plan.wanted = {.linear = false, .display = false, .display_bits = job->png_bits, .files = true};
  bool exr_output = o.outputs.empty();
  for (const std::string& output : o.outputs) {
    const auto format = output_format(output);
    if (!format) return std::unexpected(format.error());
    (*format == OutputFormat::exr ? plan.wanted.linear : plan.wanted.display) = true;
    exr_output |= *format == OutputFormat::exr;
  }
  if (auto good = check_layers(*job, exr_output); !good) return std::unexpected(good.error());
  if (o.outputs.empty()) plan.wanted.linear = true, plan.wanted.display = !o.steps.empty();
  if (!plan.all_cameras) {
    for (const Moment& moment : plan.moments) plan.shots.push_back({moment, "", ""});
    if (auto named = name_shots(o, plan.shots); !named) return std::unexpected(named.error());
  }
  if (auto ready = plan_dumps(o, plan); !ready) return std::unexpected(ready.error());
  if (auto ready = check_reports(o.timings, o.trace, o.job.json); !ready) return std::unexpected(ready.error());
  if (!o.steps.empty())
    if (auto ready = check_steps(o.steps, plan.job); !ready) return std::unexpected(ready.error());
  return plan;
}

// Lines between the device's and what was written: five in all.
size_t most_notes() { return WaitingLine::left_a_line() ? 2 : 3; }

void say_written(const std::vector<fs::path>& paths) {
  std::vector<std::string> names;
  for (const fs::path& path : paths) names.push_back(path.string());
  if (!names.empty()) log::headline("wrote {}", joined(names));
}

// Runs the same frame again and again and compares what every pass wrote.
Expected<int> check_determinism(Session& session, const RenderOptions& o, const RenderPlan& plan,
                                std::vector<std::string>& warnings) {
  std::vector<gpu::PassHash> first;
  for (int run = 1; run <= *o.check_determinism; ++run) {
    const auto frame = session.render(plan.moments.front().time_s, true);
    if (!frame) return std::unexpected(frame.error());
    if (auto noted = note_frame(*frame, session.scene(), strictness(o.job.strict), warnings); !noted)
      return std::unexpected(noted.error());
    if (run == 1) {
      first = frame->hashes;
      continue;
    }
    for (size_t i = 0; i < std::max(first.size(), frame->hashes.size()); ++i) {
      if (i < first.size() && i < frame->hashes.size() && first[i].pass == frame->hashes[i].pass &&
          first[i].resource == frame->hashes[i].resource && first[i].hash == frame->hashes[i].hash)
        continue;
      const gpu::PassHash& differs = i < first.size() ? first[i] : frame->hashes[i];
      const std::string text =
          fmt::format("run {} differs from run 1, first in pass {}, {}", run, differs.pass, differs.resource);
      log::error("{}", text);
      if (o.job.json)
        if (auto printed = print_json(
                {{"deterministic", false}, {"run", run}, {"pass", differs.pass}, {"resource", differs.resource}});
            !printed)
          return std::unexpected(printed.error());
      return int(ErrorKind::comparison);
    }
  }
  log::release(most_notes());
  log::info("{} runs agree in all {} outputs of all passes", *o.check_determinism, first.size());
  if (!o.job.json) return 0;
  Json hashes = Json::array();
  for (const gpu::PassHash& h : first)
    hashes.push_back({{"pass", h.pass}, {"resource", h.resource}, {"hash", h.hash.hex()}});
  if (auto printed = print_json({{"deterministic", true}, {"runs", *o.check_determinism}, {"hashes", hashes}});
      !printed)
    return std::unexpected(printed.error());
  return 0;
}

Json picture_json(const Shot& shot, const FrameResult& frame) {
  Json j;
  j["outputs"] = Json::array();
  for (const fs::path& path : shot.paths) j["outputs"].push_back(path.string());
  if (shot.moment.frame) j["frame"] = *shot.moment.frame, j["fps"] = shot.moment.rate.text();
  j["time_s"] = shot.moment.time_s;
  j["camera"] = frame.view.name;
  j["plan_hash"] = frame.plan_hash.hex();
  j["notes"] = frame.notes;
  return j;
}

// Of a call for one picture.
Expected<void> write_reports(const RenderOptions& o, const RenderPlan& plan, const Shot& shot, const FrameResult& frame,
                             const Session& session, const std::vector<std::string>& warnings) {
  if (!o.timings.empty())
    if (auto written = write_text_output(o.timings, timings_json(frame, plan.job, session).dump(2) + "\n"); !written)
      return written;
  if (!o.trace.empty()) {
    std::vector<Timings::Span> spans = session.opening().spans;
    spans.insert(spans.end(), frame.timings.spans.begin(), frame.timings.spans.end());
    if (auto written = write_text_output(o.trace, trace_json(spans)); !written) return written;
  }
  if (!o.job.json) return {};
  Json j = result_head(plan.job, session, warnings);
  j.update(picture_json(shot, frame));
  if (!plan.dump_paths.empty()) j["dumps"] = Json::array();
  for (const fs::path& path : plan.dump_paths) j["dumps"].push_back(path.string());
  j["timings"] = timings_json(frame, plan.job, session);
  j["timings"].erase("job");
  return print_json(j);
}

Expected<FrameResult> render_shot(const RenderOptions& o, const RenderPlan& plan, const Shot& shot, Session& session,
                                  std::vector<std::string>& warnings, SaidOnce& said) {
  log::gather();
  Job job = plan.job;
  if (!shot.camera.empty()) {
    job.camera.camera = shot.camera;
    if (!job.camera.fit) job.camera.framing = Framing::boxes;  // as where the camera is named
    session.set_camera(job.camera);
  }
  auto frame = [&] {
    const WaitingLine waiting("rendering", o.job.quiet);
    return session.render(shot.moment.time_s);
  }();
  if (!frame) return frame;
  log_look(job, frame->request.look);
  for (const std::string& note : frame->notes) said.note(note);
  if (auto noted = note_frame(*frame, session.scene(), strictness(o.job.strict), warnings); !noted)
    return std::unexpected(noted.error());
  const bool several = plan.shots.size() > 1;
  const BlankRules rules{.strict = strictness(o.job.strict) == Strictness::all,
                         .allowed = o.job.allow_blank,
                         .frame = several ? shot.moment.frame : std::nullopt};
  if (auto noted = note_blank(*frame, job, session.scene(), rules, warnings); !noted)
    return std::unexpected(noted.error());
  note_tones(*frame, job, said);
  {
    HeldSignals held;
    if (auto written = write_outputs(*frame, job, session, shot.moment.frame, shot.moment.rate, shot.paths); !written) {
      Error error = written.error();
      if (error.kind == ErrorKind::nonfinite) error.message += first_nonfinite_pass(session, shot.moment.time_s);
      return std::unexpected(error);
    }
    if (auto written = write_dumps(*frame, job, session, plan.dump_paths); !written)
      return std::unexpected(written.error());
  }
  // What writing warns of is not the scene's fault, which --strict is about.
  if (auto noted = note_frame(*frame, session.scene(), Strictness::none, warnings); !noted)
    return std::unexpected(noted.error());
  log::release(most_notes());
  say_written(shot.paths);
  return frame;
}

Expected<int> run_render(CLI::App& command, RenderOptions& o) {
  if (auto read = read_config(command, o.job.config); !read) return std::unexpected(read.error());
  set_log_level(o.job);
  log::gather();
  auto settings = run_settings_of(o.job);
  if (!settings) return std::unexpected(settings.error());
  auto plan = plan_render(command, o);
  if (!plan) return std::unexpected(plan.error());
  if (o.overlap && o.timings.empty() && !o.job.json)
    return fail(ErrorKind::usage, "--overlap", "is written with the times; add --timings FILE or --json");
  settings->overlap = o.overlap;
  settings->command = command_line();
  settings->timeout_folder = folder_of_outputs(o.outputs);
  settings->timed = !o.timings.empty() || !o.trace.empty() || !o.steps.empty() || plan->job.timings_in_metadata;
  auto session = [&] {
    const WaitingLine waiting("opening the scene and the device", o.job.quiet);
    return Session::open(plan->job, plan->wanted, *settings);
  }();
  if (!session) return std::unexpected(session.error());
  log_device((*session)->device().info());
  note_fall_to_cpu((*session)->device().info(), o.job, false);
  if (auto noted = note_scene((*session)->scene(), strictness(o.job.strict)); !noted)
    return std::unexpected(noted.error());
  if (plan->all_cameras) {
    plan->shots = shots_of_cameras((*session)->scene(), plan->moments);
    if (plan->shots.empty()) return fail(ErrorKind::usage, "--camera", "all: {} has no cameras", plan->job.scene);
    if (auto named = name_shots(o, plan->shots); !named) return std::unexpected(named.error());
  }
  std::vector<std::string> warnings;
  SaidOnce said;
  if (o.check_determinism)
    if (const auto same = check_determinism(**session, o, *plan, warnings);
        !same || *same != 0 || plan->shots.front().paths.empty())
      return same;
  Json pictures = Json::array();
  for (const Shot& shot : plan->shots) {
    const auto frame = render_shot(o, *plan, shot, **session, warnings, said);
    if (!frame) return std::unexpected(frame.error());
    if (plan->shots.size() > 1 || plan->all_cameras) {
      if (o.job.json) pictures.push_back(picture_json(shot, *frame));
      continue;
    }
    say_written(plan->dump_paths);
    if (auto reported = write_reports(o, *plan, shot, *frame, **session, warnings); !reported)
      return std::unexpected(reported.error());
    if (o.steps.empty()) continue;
    const std::string device = (*session)->device().info().name;
    if (auto written = write_steps(o.steps, plan->job, *settings, *frame, device); !written)
      return std::unexpected(written.error());
    say_written({fs::path(o.steps) / "index.html"});
  }
  if (o.job.json && !pictures.empty()) {
    Json j = result_head(plan->job, **session, warnings);
    j["pictures"] = std::move(pictures);
    if (auto printed = print_json(j); !printed) return std::unexpected(printed.error());
  }
  return 0;
}

}  // namespace

void add_render(CLI::App& app, Action& action) {
  auto o = std::make_shared<RenderOptions>();
  CLI::App* command = app.add_subcommand("render", "Render one frame to EXR or PNG");
  add_job_options(*command, o->job);
  add_moment_options(*command, o->moment);
  command
      ->add_option(
          "--frames", o->frames,
          "Several frames: 0-249, 1-100x5, 2,4,10-20 or all (candela sequence is faster, resumes and makes films)")
      ->type_name("LIST");
  command
      ->add_option("-o,--output", o->outputs,
                   "File to write; the ending chooses EXR or PNG; {frame:04}, %04d, #### or $F4 is the frame number, "
                   "{camera} the camera's name; may be given again")
      ->allow_extra_args(false)
      ->type_name("FILE");
  command
      ->add_option("--steps", o->steps,
                   "Folder for a page that shows the frame pass by pass: what each pass writes and reads, and its time")
      ->type_name("DIR");
  command
      ->add_option("--dump", o->dumps,
                   "Write an image of the frame as it is after a pass, PASS.IMAGE[mip,layer]=FILE.exr; may be given "
                   "again; candela plan lists passes and images")
      ->allow_extra_args(false)
      ->type_name("PASS.IMAGE=FILE.exr");
  add_budget_options(*command, o->budget);
  command->add_option("--timings", o->timings, "Times of every pass and stage as JSON; - is stdout")->type_name("FILE");
  command->add_option("--trace", o->trace, "The same as a Chrome trace, which Perfetto opens; - is stdout")
      ->type_name("FILE");
  command->add_flag("--overlap", o->overlap,
                    "With the times: also time the whole frame with passes side by side on two queues, and on one");
  command
      ->add_option("--check-determinism", o->check_determinism,
                   "Render N times and compare what every pass wrote; exit 1 when it differs")
      ->type_name("N");
  add_run_options(*command, o->job);
  command->callback([command, o, &action] { action = [command, o] { return run_render(*command, *o); }; });
}

}  // namespace candela::cli
