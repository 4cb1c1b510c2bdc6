#include "render/sequence.h"

#include <sys/prctl.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>

#include "base/json.h"
#include "base/log.h"
#include "cli/command.h"
#include "cli/output_paths.h"
#include "cli/progress.h"
#include "cli/result.h"
#include "cli/scene_notes.h"
#include "cli/sequence_options.h"
#include "cli/signals.h"
#include "farm/run_record.h"
#include "job/job_look.h"
#include "render/current_error.h"
#include "render/shared_frames.h"
#include "render/traced_frames.h"
#include "session/timings.h"

namespace candela::cli {
namespace {

using Json = nlohmann::ordered_json;

// For images that frames with the same content share: three times the default maps of two suns.
constexpr uint64_t kept_bytes = uint64_t(512) << 20;

Expected<SequenceSettings> settings_of(const SequenceOptions& o, const Job& job) {
  auto settings = read_sequence(o, job);
  if (!settings) return settings;
  if (auto good = check_sequence(*settings); !good) return std::unexpected(good.error());
  if (auto good = check_reports(o.timings, o.trace, o.job.json); !good) return std::unexpected(good.error());
  return settings;
}

Json sequence_timings(const SequenceResult& result, const Session& session) {
  Json j;
  j["device"] = device_json(session.device().info());
  j["frames_rendered"] = result.rendered;
  j["plan_hashes"] = Json::array();
  for (const Hash128& hash : result.plan_hashes) j["plan_hashes"].push_back(hash.hex());
  if (!result.timings.gpu_ms.empty()) j["gpu_frame_ms"] = result.timings.frame_gpu_ms;  // absent: not timed
  for (const gpu::PassTime& pass : result.timings.gpu_ms) j["gpu_ms"][pass.name] = pass.gpu_ms;
  j["cpu_ms"] = cpu_json(session.opening(), result.timings);
  j["process_ms"] = process_clock_us() * 1e-3;
  j["memory"] = memory_json(session, result.plan);
  j["local_maps"] = {{"used", result.timings.lamp_maps},
                     {"drawn", result.timings.lamp_maps_drawn},
                     {"drawn_over", result.timings.lamp_maps_over}};
  j["uploaded_bytes"] = uploaded_json(session.opening(), result.timings);
  j["heap_allocations"] = result.timings.heap_allocations;
  return j;
}

void add_film(Json& j, const SequenceOptions& o, const SequenceResult& result) {
  j["outputs"] = o.outputs;
  if (!o.video.empty()) j["video"] = o.video;
  j["frames"] = o.frames;
  j["shard"] = o.shard;
  j["fps"] = o.job.fps;
  j["rendered"] = result.rendered;
  j["skipped"] = result.skipped;
}

Expected<void> write_reports(const SequenceOptions& o, const Job& job, const SequenceResult& result,
                             const Session& session, const std::vector<std::string>& warnings) {
  if (!o.timings.empty()) {
    Json timings = sequence_timings(result, session);
    timings["job"] = own_json(job_json(job));
    if (auto written = write_text_output(o.timings, timings.dump(2) + "\n"); !written) return written;
  }
  if (!o.trace.empty()) {
    std::vector<Timings::Span> spans = session.opening().spans;
    spans.insert(spans.end(), result.timings.spans.begin(), result.timings.spans.end());
    if (auto written = write_text_output(o.trace, trace_json(spans)); !written) return written;
  }
  if (!o.job.json) return {};
  Json j = result_head(job, session, warnings);
  add_film(j, o, result);
  j["timings"] = sequence_timings(result, session);
  return print_json(j);
}

// The frame of an error that holds non-finite pixels stands at its beginning: "frame 12: ...".
Error with_first_pass(Error error, Session& session, FrameRate rate) {
  int64_t frame = 0;
  if (error.kind == ErrorKind::nonfinite && std::sscanf(error.message.c_str(), "frame %ld:", &frame) == 1)
    error.message += first_nonfinite_pass(session, rate.seconds(frame));
  return error;
}

auto progress_of(ProgressLine& line, std::optional<RunRecorder>& recorder) {
  return [&](const SequenceProgress& p) {
    line.show(p);
    if (recorder) recorder->progress(p.done - p.skipped, p.skipped);
  };
}

int interrupted(const SequenceSettings& settings, const SequenceResult& result, HeldSignals& held,
                std::optional<RunRecorder>& recorder) {
  log::warning("interrupted after {} of {} frames; the same command with --resume goes on",
               result.rendered + result.skipped, settings.frames.size());
  if (recorder) recorder->end(128 + held.pending(), "interrupted");  // `held` lets the signal end the program
  return 128 + held.pending();
}

Expected<int> render(const SequenceOptions& o, const Job& job, std::optional<RunRecorder>& recorder) {
  auto run_settings = run_settings_of(o.job);
  if (!run_settings) return std::unexpected(run_settings.error());
  auto settings = settings_of(o, job);
  if (!settings) return std::unexpected(settings.error());
  run_settings->command = command_line();
  run_settings->timeout_folder = folder_of_outputs(o.outputs.empty() ? std::vector{o.video} : o.outputs);
  run_settings->timed = !o.timings.empty() || job.timings_in_metadata;
  run_settings->spans = !o.trace.empty();
  if (o.cache == "on" || (o.cache == "auto" && !run_settings->timed)) run_settings->kept_bytes = kept_bytes;
  auto session = Session::open(job, wanted_by(*settings, job), *run_settings);
  if (!session) return std::unexpected(session.error());
  const gpu::DeviceInfo& device = (*session)->device().info();
  log_device(device);
  note_fall_to_cpu(device, o.job, recorder.has_value());
  if (recorder)
    recorder->opened((*session)->scene_content().hex(), device.name, device.driver, settings->frames.size());
  if (const auto look = look_of(job)) log_look(job, *look);
  if (auto noted = note_scene((*session)->scene(), strictness(o.job.strict)); !noted)
    return std::unexpected(noted.error());

  std::unique_ptr<SharedFrames> shared;
  if (!o.worker.empty()) {
    auto opened = SharedFrames::open(o.worker, settings->frames.size());
    if (!opened) return std::unexpected(opened.error());
    shared = std::move(*opened);
    settings->claim = [&](size_t i) { return shared->claim(i); };
    settings->finished = [&](size_t i, bool rendered) { shared->finish(i, rendered); };
  }
  std::vector<std::string> warnings;
  SaidOnce said;
  ProgressLine progress(o.job.quiet);
  settings->progress = progress_of(progress, recorder);
  settings->rendered = [&](int64_t frame, const FrameResult& result) -> Expected<void> {
    for (const std::string& note : result.notes) said.note(note);
    if (auto noted = note_frame(result, (*session)->scene(), strictness(o.job.strict), warnings); !noted) return noted;
    note_tones(result, job, said);
    return note_blank(
        result, job, (*session)->scene(),
        {.strict = strictness(o.job.strict) == Strictness::all, .allowed = o.job.allow_blank, .frame = frame},
        warnings);
  };
  HeldSignals held;
  settings->stop = &held.pending();
  const auto result = run_sequence(**session, job, *settings);
  progress.end();
  if (!result) return std::unexpected(with_first_pass(result.error(), **session, settings->rate));
  if (result->stopped) return interrupted(*settings, *result, held, recorder);
  log::info("{} frames rendered, {} were there", result->rendered, result->skipped);
  if (auto reported = write_reports(o, job, *result, **session, warnings); !reported)
    return std::unexpected(reported.error());
  return 0;
}

// A film of --technique reference.
Expected<int> trace(const SequenceOptions& o, const FilmJob& film, std::optional<RunRecorder>& recorder) {
  const Job& job = film.job;
  auto settings = settings_of(o, job);
  if (!settings) return std::unexpected(settings.error());
  std::optional<tbb::global_control> threads;
  if (o.tracing.threads > 0) threads.emplace(tbb::global_control::max_allowed_parallelism, size_t(o.tracing.threads));
  const auto maker = TracedFrames::open(job, *film.traced, settings->rate, wanted_by(*settings, job));
  if (!maker) return std::unexpected(maker.error());
  const Scene& scene = (*maker)->scene();
  const std::string content = (*maker)->scene_content().hex();
  if (recorder) recorder->opened(content, traced_technique, (*maker)->request_text(), settings->frames.size());
  if (const auto look = look_of(job)) log_look(job, *look);
  if (auto noted = note_scene(scene, strictness(o.job.strict)); !noted) return std::unexpected(noted.error());
  std::vector<std::string> warnings;
  SaidOnce said;
  ProgressLine progress(o.job.quiet);
  settings->progress = progress_of(progress, recorder);
  settings->rendered = [&](int64_t, const FrameResult& result) {
    for (const std::string& note : result.notes) said.note(note);
    return note_frame(result, scene, strictness(o.job.strict), warnings);
  };
  HeldSignals held;
  settings->stop = &held.pending();
  (*maker)->set_stop(settings->stop);
  const auto result = run_sequence(**maker, job, *settings);
  progress.end();
  if (!result) return std::unexpected(result.error());
  if (result->stopped) return interrupted(*settings, *result, held, recorder);
  log::info("{} frames traced, {} were there", result->rendered, result->skipped);
  if (!o.job.json) return 0;
  Json j;
  j["version"] = CANDELA_VERSION;
  j["job"] = own_json(job_json(job));
  j["reference"] = own_json(settings_json(film.traced->settings, film.traced->accel));
  j["scene_content"] = content;
  j["warnings"] = warnings;
  add_film(j, o, *result);
  if (auto printed = print_json(j); !printed) return std::unexpected(printed.error());
  return 0;
}

Expected<int> make_film(const CLI::App& command, SequenceOptions& o, std::optional<RunRecorder>& recorder) {
  const auto film = film_job(command, o);
  if (!film) return std::unexpected(film.error());
  return film->traced ? trace(o, *film, recorder) : render(o, film->job, recorder);
}

// A worker of --devices without its parent would render for no one.
void end_with_parent() { prctl(PR_SET_PDEATHSIG, SIGTERM); }

Expected<int> run(CLI::App& command, SequenceOptions& o) {
  if (auto read = read_config(command, o.job.config); !read) return std::unexpected(read.error());
  set_log_level(o.job);
  if (!o.devices.empty() && o.worker.empty()) return run_on_devices(command, o);
  if (!o.worker.empty()) end_with_parent();
  std::optional<RunRecorder> recorder;
  if (const auto shard = parse_shard(o.shard); shard && !o.record.empty()) recorder.emplace(o.record, *shard);
  try {
    auto code = make_film(command, o, recorder);
    if (recorder) recorder->end(code ? *code : int(code.error().kind), code ? "" : code.error().text());
    return code;
  } catch (...) {
    const Error error = current_error();
    if (recorder) recorder->end(int(error.kind), error.text());
    return std::unexpected(error);
  }
}

}  // namespace

void add_sequence(CLI::App& app, Action& action) {
  auto o = std::make_shared<SequenceOptions>();
  CLI::App* command = app.add_subcommand("sequence", "Render a list of frames to files or a video");
  add_film_options(*command, *o);
  command->add_flag(
      "--resume", o->resume,
      "Skip frames whose files are complete and belong to this job; with --video those kept beside the film");
  command->add_option("--shard", o->shard, "Render share I of N of the list: every N-th frame, beginning with the I-th")
      ->capture_default_str()
      ->type_name("I/N");
  command
      ->add_option("--devices", o->devices,
                   "Start a process on each of these devices, all working on one list of frames: names as for "
                   "--device, separated by commas, or all")
      ->type_name("LIST");
  command->add_option("--worker", o->worker)->group("")->configurable(false);  // what --devices starts
  command
      ->add_option("--record", o->record,
                   "Folder for a record of this run: node, device, frames, exit code (docs/using/farm.md)")
      ->type_name("DIR");
  command->add_option("--timings", o->timings, "Times summed over the frames as JSON; - is stdout")->type_name("FILE");
  command
      ->add_option("--trace", o->trace,
                   "What host, device and encoders did when, as a Chrome trace, which Perfetto "
                   "opens; frames overlap as without it (with --timings they don't, and passes are in it); - is stdout")
      ->type_name("FILE");
  add_run_options(*command, o->job);
  command->callback([command, o, &action] { action = [command, o] { return run(*command, *o); }; });
}

}  // namespace candela::cli
