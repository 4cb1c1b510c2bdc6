#include "render/sequence.h"

#include <CLI/CLI.hpp>

#include "base/json.h"
#include "base/log.h"
#include "cli/command.h"
#include "cli/job_options.h"
#include "cli/progress.h"
#include "cli/result.h"
#include "cli/scene_notes.h"
#include "cli/signals.h"
#include "frame/job_look.h"
#include "frame/timings.h"

namespace candela::cli {
namespace {

using Json = nlohmann::ordered_json;

// For images that frames with the same content share: three times the default maps of two suns.
constexpr uint64_t kept_bytes = uint64_t(512) << 20;

struct SequenceOptions {
  JobOptions job;
  std::string frames, shard = "1/1", video, audio, timings, trace;
  std::vector<std::string> outputs;
  bool resume = false;
  int in_flight = 0, encoders = 0;
  std::string cache = "auto";
};

Expected<SequenceSettings> settings_of(const SequenceOptions& o, const Job& job) {
  SequenceSettings settings;
  if (o.frames.empty() && o.job.turntable == 0)
    return fail(ErrorKind::usage, "--frames", "no frames given; write 0-249, 1-100x5 or 2,4,10-20");
  const auto frames = parse_frame_list(o.frames.empty() ? fmt::format("0-{}", o.job.turntable - 1) : o.frames);
  if (!frames) return std::unexpected(Error{ErrorKind::usage, frames.error().message, "--frames"});
  const auto shard = parse_shard(o.shard);
  if (!shard) return std::unexpected(shard.error());
  const auto rate = parse_frame_rate(o.job.fps);
  if (!rate) return std::unexpected(Error{ErrorKind::usage, rate.error().message, "--fps"});
  for (const std::string& text : o.outputs) {
    const auto pattern = parse_pattern(text);
    if (!pattern) return std::unexpected(pattern.error());
    settings.patterns.push_back(*pattern);
  }
  if (shard->count > 1 && !o.video.empty())
    return fail(ErrorKind::usage, "--shard", "does not go with --video, which needs every frame of one run");
  if (!o.video.empty() && job.png_bits != 8)
    return fail(ErrorKind::usage, "--png-bits", "16 does not go with --video, which has 8 bits");
  const bool exr_output = std::any_of(o.outputs.begin(), o.outputs.end(),
                                      [](const auto& output) { return output_format(output) == OutputFormat::exr; });
  if (auto good = check_layers(job, exr_output); !good) return std::unexpected(good.error());
  settings.frames = shard_of(*frames, *shard);
  settings.rate = *rate;
  settings.resume = o.resume;
  settings.in_flight = o.in_flight;
  settings.encoders = o.encoders;
  settings.video = o.video;
  settings.audio = o.audio;
  settings.keep_spans = !o.trace.empty();
  if (auto good = check_sequence(settings); !good) return std::unexpected(good.error());
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
  return j;
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
  j["outputs"] = o.outputs;
  if (!o.video.empty()) j["video"] = o.video;
  j["frames"] = o.frames;
  j["shard"] = o.shard;
  j["fps"] = o.job.fps;
  j["rendered"] = result.rendered;
  j["skipped"] = result.skipped;
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

Expected<int> run(CLI::App& command, SequenceOptions& o) {
  if (auto read = read_config(command, o.job.config); !read) return std::unexpected(read.error());
  set_log_level(o.job);
  const auto job = job_of(o.job);
  if (!job) return std::unexpected(job.error());
  auto run_settings = run_settings_of(o.job);
  if (!run_settings) return std::unexpected(run_settings.error());
  auto settings = settings_of(o, *job);
  if (!settings) return std::unexpected(settings.error());
  run_settings->timed = !o.timings.empty() || !o.trace.empty() || job->timings_in_metadata;
  auto session = Session::open(*job, wanted_by(*settings, *job), *run_settings);
  if (!session) return std::unexpected(session.error());
  log_device((*session)->device().info());
  if (const auto look = look_of(*job)) log_look(*job, *look);
  if (auto noted = note_scene((*session)->scene(), o.job.strict); !noted) return std::unexpected(noted.error());

  std::vector<std::string> warnings;
  std::set<std::string> notes;
  ProgressLine progress(o.job.quiet);
  settings->progress = [&](const SequenceProgress& p) { progress.show(p); };
  settings->rendered = [&](int64_t frame, const FrameResult& result) -> Expected<void> {
    for (const std::string& note : result.notes)
      if (notes.size() < 1000 && notes.insert(note).second) log::info("{}", note);
    if (auto noted = note_frame(result, (*session)->scene(), o.job.strict, warnings); !noted) return noted;
    return note_blank(result, *job, (*session)->scene(),
                      {.strict = o.job.strict, .allowed = o.job.allow_blank, .frame = frame}, warnings);
  };
  if (!settings->video.empty() && (job->width_px % 2 != 0 || job->height_px % 2 != 0))
    log::warning("the film is {}x{}: H.264 with 4:2:0 chroma takes even sides, so {}x{} grows by a black row or column",
                 job->width_px + job->width_px % 2, job->height_px + job->height_px % 2, job->width_px, job->height_px);
  HeldSignals held;
  settings->stop = &held.pending();
  const auto result = run_sequence(**session, *job, *settings);
  progress.end();
  if (!result) return std::unexpected(with_first_pass(result.error(), **session, settings->rate));
  if (result->stopped) {
    log::warning("interrupted after {} of {} frames; {}", result->rendered + result->skipped, settings->frames.size(),
                 o.video.empty() ? "the same command with --resume goes on" : "the video was not written");
    return 128 + held.pending();
  }
  log::info("{} frames rendered, {} were there", result->rendered, result->skipped);
  if (auto reported = write_reports(o, *job, *result, **session, warnings); !reported)
    return std::unexpected(reported.error());
  return 0;
}

}  // namespace

void add_sequence(CLI::App& app, Action& action) {
  auto o = std::make_shared<SequenceOptions>();
  CLI::App* command = app.add_subcommand("sequence", "Render a list of frames to files or a video");
  add_job_options(*command, o->job);
  command
      ->add_option(
          "--frames", o->frames,
          "Frames, ends included: 0-249, 1-100x5 or 2,4,10-20; with --turntable N 0 to N - 1 where it is left out")
      ->type_name("LIST");
  command
      ->add_option("-o,--output", o->outputs,
                   "Files to write, with %04d or #### for the frame number; may be given again")
      ->allow_extra_args(false)
      ->type_name("PATTERN");
  command->add_option("--video", o->video, "Film to write (.mp4, .mov or .mkv), through ffmpeg")->type_name("FILE");
  command->add_option("--audio", o->audio, "Sound of the film")->type_name("FILE");
  command->add_flag("--resume", o->resume, "Leave out frames whose files are whole and hold this job's picture");
  command
      ->add_option("--cache", o->cache,
                   "on: shadow maps stay for later frames as long as nothing that casts moves, with the same pictures; "
                   "off: every frame draws its own; auto: off where frames are timed")
      ->check(CLI::IsMember({"auto", "on", "off"}))
      ->capture_default_str();
  command->add_option("--in-flight", o->in_flight, "Frames on their way to the device at once; 0: as suits the device")
      ->check(CLI::Range(0, 8))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--encoders", o->encoders, "Threads that encode and write frames; 0: as many as cores")
      ->check(CLI::Range(0, 256))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--shard", o->shard, "Part I of N of the list: every N-th frame from the I-th on")
      ->capture_default_str()
      ->type_name("I/N");
  command->add_option("--timings", o->timings, "Times summed over the frames as JSON; - is stdout")->type_name("FILE");
  command->add_option("--trace", o->trace, "The same as a Chrome trace; - is stdout")->type_name("FILE");
  add_run_options(*command, o->job);
  command->callback([command, o, &action] { action = [command, o] { return run(*command, *o); }; });
}

}  // namespace candela::cli
