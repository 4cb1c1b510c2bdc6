#include "cli/sequence_options.h"

#include <cstdlib>

#include "base/text.h"
#include "cli/result.h"
#include "job/picture_window.h"
#include "render/film_frames.h"

namespace candela::cli {

void add_film_options(CLI::App& command, SequenceOptions& o) {
  add_job_options(command, o.job);
  command
      .add_option("--frames", o.frames,
                  "Frames, in this order, both ends included: 0-249, 1-100x5 or 2,4,10-20; all: as long as the "
                  "animations that play; by default 0 to N - 1 with --turntable N")
      ->type_name("LIST");
  command
      .add_option("-o,--output", o.outputs,
                  "Files to write, with %04d or #### for the frame number; may be given again")
      ->allow_extra_args(false)
      ->type_name("PATTERN");
  command.add_option("--video", o.video, "Film to write (.mp4, .mov, .mkv or .webm), through ffmpeg")
      ->type_name("FILE");
  add_codec_options(command, o.video_codec, o.video_pad, o.audio);
  command
      .add_option("--cache", o.cache,
                  "on: keep shadow maps for later frames as long as nothing that casts shadows moves, with the same "
                  "pictures; off: draw them for every frame; auto: off if frames are timed")
      ->check(CLI::IsMember({"auto", "on", "off"}))
      ->capture_default_str();
  command.add_option("--in-flight", o.in_flight, "How many frames are on the device at once; 0: as suits the device")
      ->check(CLI::Range(0, 8))
      ->capture_default_str()
      ->type_name("N");
  command.add_option("--encoders", o.encoders, "Threads that encode and write frames; 0: as many as cores")
      ->check(CLI::Range(0, 256))
      ->capture_default_str()
      ->type_name("N");
  add_trace_options(command, o.tracing);
  command.get_option("--technique")
      ->description("How frames are made (candela list techniques); reference traces them, as `reference` does");
}

namespace {

// One that the environment gives is meant for the commands that have it.
Expected<void> refuse(const CLI::App& command, std::initializer_list<const char*> names, const char* why) {
  for (const char* name : names) {
    const CLI::Option* option = command.get_option_no_throw(name);
    if (!option || option->count() == 0) continue;
    if (!option->get_envname().empty() && std::getenv(option->get_envname().c_str())) continue;
    return fail(ErrorKind::usage, name, "{}", why);
  }
  return {};
}

Expected<Job> traced_job(const JobOptions& o) {
  JobOptions common = o;
  common.technique = JobOptions().technique;
  common.layers.clear();
  common.view = JobOptions().view;
  auto job = job_of(common);
  if (!job) return job;
  job->technique = traced_technique;
  job->view = o.view;
  if (o.layers == all_layers)
    job->layers = reference_layer_names();
  else if (!o.layers.empty() && o.layers != "none")
    job->layers = split(o.layers, ',');
  if (auto good = check_traced_job(*job); !good) return std::unexpected(good.error());
  return job;
}

}  // namespace

namespace {

// A codec of more than 8 bits has pictures of 16 where none are asked for.
Expected<void> choose_bits(const CLI::App& command, SequenceOptions& o) {
  if (o.video.empty()) return {};
  const auto codec = film_codec({.path = o.video, .codec = o.video_codec});
  if (!codec) return std::unexpected(codec.error());
  if ((*codec)->deep_by_default && command.get_option("--png-bits")->count() == 0) o.job.png_bits = 16;
  return {};
}

Expected<FilmJob> checked_film(const CLI::App& command, SequenceOptions& o) {
  if (auto good = choose_bits(command, o); !good) return std::unexpected(good.error());
  if (o.job.technique != traced_technique) {
    if (auto good =
            refuse(command,
                   {"--mode", "--spp", "--noise", "--sampler", "--bvh", "--visibility", "--ambient",
                    "--ambient-distance", "--bounces", "--fog-steps", "--fog-lights", "--footprints", "--threads"},
                   "says how --technique reference traces; other techniques have none of it");
        !good)
      return std::unexpected(good.error());
    const auto job = job_of(o.job);
    if (!job) return std::unexpected(job.error());
    return FilmJob{*job, std::nullopt};
  }
  if (auto good = refuse(command,
                         {"--transparency", "--quality", "--effects", "--set", "--samples", "--device", "--devices",
                          "--queues", "--validate", "--shader-dir", "--timeout", "--cache", "--in-flight", "--timings",
                          "--trace", "--metadata-timings", "--allow-blank"},
                         "says how a GPU makes frames; --technique reference traces them on the CPU");
      !good)
    return std::unexpected(good.error());
  const auto job = traced_job(o.job);
  if (!job) return std::unexpected(job.error());
  const auto request = trace_request(o.tracing, *job);
  if (!request) return std::unexpected(request.error());
  return FilmJob{*job, *request};
}

}  // namespace

Expected<FilmJob> film_job(const CLI::App& command, SequenceOptions& o) {
  auto film = checked_film(command, o);
  if (!film) return film;
  const auto frames = with_all_frames(o.frames, film->job, o.job.fps);
  if (!frames) return std::unexpected(frames.error());
  o.frames = *frames;
  return film;
}

std::string frames_text(const SequenceOptions& o) {
  return o.frames.empty() && o.job.turntable > 0 ? fmt::format("0-{}", o.job.turntable - 1) : o.frames;
}

std::vector<std::string> given_words(const CLI::App& command, const std::set<std::string>& without) {
  std::vector<std::string> words;
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    if (option->get_positional()) {  // the scene
      const std::string& value = option->results().front();
      words.insert(words.begin(), value.starts_with('-') ? "./" + value : value);
      continue;
    }
    if (option->get_lnames().empty() || without.contains(option->get_lnames().front())) continue;
    const std::string name = "--" + option->get_lnames().front();
    if (option->get_expected_max() == 0) {
      const std::string& value = option->results().front();
      words.push_back(value == "loss" ? name + "=" + value : name);
      continue;
    }
    for (const std::string& value : option->results())
      if (value.starts_with('-'))
        words.push_back(name + "=" + value);
      else
        words.insert(words.end(), {name, value});
  }
  return words;
}

Expected<SequenceSettings> read_sequence(const SequenceOptions& o, const Job& job) {
  SequenceSettings settings;
  const std::string list = frames_text(o);
  if (list.empty())
    return fail(ErrorKind::usage, "--frames", "no frames given; write 0-249, 1-100x5, 2,4,10-20 or all");
  const auto frames = parse_frame_list(list);
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
  settings.film = {.path = o.video, .audio = o.audio, .codec = o.video_codec, .pad = o.video_pad};
  if (!o.video.empty()) {
    const PixelRect data = picture_window(job).data;
    if (auto good = check_film_size(settings.film, data.width, data.height); !good)
      return std::unexpected(good.error());
  }
  const bool exr_output = std::any_of(o.outputs.begin(), o.outputs.end(),
                                      [](const auto& output) { return output_format(output) == OutputFormat::exr; });
  if (auto good = check_layers(job, exr_output); !good) return std::unexpected(good.error());
  settings.frames = shard_of(*frames, *shard);
  settings.rate = *rate;
  settings.resume = o.resume;
  settings.in_flight = o.in_flight;
  settings.encoders = o.encoders;
  if (!o.video.empty() && film_output(o.outputs) < 0) settings.kept = kept_frames(o.video);
  settings.keep_spans = !o.trace.empty();
  return settings;
}

}  // namespace candela::cli
