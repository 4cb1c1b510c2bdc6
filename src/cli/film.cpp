#include <CLI/CLI.hpp>

#include "base/files.h"
#include "base/log.h"
#include "cli/command.h"
#include "cli/input_options.h"
#include "cli/progress.h"
#include "cli/sequence_options.h"
#include "cli/signals.h"
#include "image/io.h"
#include "render/film_frames.h"
#include "render/film_pictures.h"
#include "render/video.h"

namespace candela::cli {
namespace {

struct FilmOptions {
  std::vector<std::string> frames;
  FilmFile film;
  std::string output, audio, fps = "24", list;
  bool quiet = false;
};

// What --frames leaves of the pictures.
Expected<void> take_frames(FilmPictures& pictures, const std::string& text) {
  const auto list = parse_frame_list(text);
  if (!list) return std::unexpected(Error{ErrorKind::usage, list.error().message, "--frames"});
  if (pictures.numbers.empty())
    return fail(ErrorKind::usage, "--frames", "goes with a pattern or a folder, whose files have numbers");
  FilmPictures taken;
  for (const int64_t number : *list) {
    const auto found = std::ranges::lower_bound(pictures.numbers, number);
    if (found == pictures.numbers.end() || *found != number)
      return fail(ErrorKind::input, "--frames", "frame {} is not there", number);
    taken.numbers.push_back(number);
    taken.files.push_back(pictures.files[size_t(found - pictures.numbers.begin())]);
  }
  pictures = std::move(taken);
  return {};
}

Expected<std::pair<int, int>> size_of(const std::string& file) {
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  const auto info = probe_image(*bytes, file);
  if (!info) return std::unexpected(info.error());
  return std::pair(info->width, info->height);
}

Expected<int> run_film(FilmOptions& o) {
  if (o.quiet) log::set_level(log::Level::warning);
  if (o.output.empty()) return fail(ErrorKind::usage, "-o", "no output given; name a file such as film.mp4");
  const auto rate = parse_frame_rate(o.fps);
  if (!rate) return std::unexpected(Error{ErrorKind::usage, rate.error().message, "--fps"});
  o.film.path = o.output, o.film.audio = o.audio;
  if (const auto codec = film_codec(o.film); !codec) {
    Error error = codec.error();
    if (error.place == "--video") error.place = "-o";
    return std::unexpected(error);
  }
  auto pictures = film_pictures(o.frames);
  if (!pictures) return std::unexpected(pictures.error());
  const std::string gaps = missing_numbers(pictures->numbers);
  if (!o.list.empty()) {
    if (auto taken = take_frames(*pictures, o.list); !taken) return std::unexpected(taken.error());
  } else if (!gaps.empty()) {
    log::warning("frames {} are missing: the film goes on without them", gaps);
  }
  const auto size = size_of(pictures->files.front());
  if (!size) return std::unexpected(size.error());
  auto video = VideoWriter::open(o.film, size->first, size->second, *rate);
  if (!video) return std::unexpected(video.error());
  HeldSignals held;
  ProgressLine line(o.quiet);
  const size_t total = pictures->files.size();
  for (size_t i = 0; i < total; ++i) {
    if (held.pending() != 0) {
      line.end();
      log::warning("interrupted after {} of {} frames; no film was written, the same command begins again", i, total);
      return 128 + held.pending();
    }
    const auto image = read_film_frame(pictures->files[i], size->first, size->second);
    if (!image) return std::unexpected(image.error());
    if (auto added = (*video)->add(*image); !added) return std::unexpected(added.error());
    line.show({.done = i + 1, .total = total});
  }
  if (auto finished = (*video)->finish(); !finished) return std::unexpected(finished.error());
  line.end();
  log::info("wrote {}: {} frames, {}x{}", o.output, total, size->first, size->second);
  return 0;
}

}  // namespace

void add_codec_options(CLI::App& command, std::string& codec, bool& pad, std::string& audio) {
  command
      .add_option(
          "--video-codec", codec,
          "How the film is stored; auto: h264, in .webm vp9; h265 (10 bits); prores (422 HQ, 10 bits) and prores4444 "
          "(with alpha) in .mov or .mkv; ffv1 and png (lossless, with alpha) in .mkv or .mov; vp9 (with alpha) in "
          ".webm or .mkv")
      ->capture_default_str()
      ->type_name("NAME");
  command.add_flag("--video-pad", pad,
                   "Add a black row or column where the codec takes even sides only, instead of refusing the size");
  command.add_option("--audio", audio, "Sound of the film")->type_name("FILE");
}

void add_film(CLI::App& app, Action& action) {
  auto o = std::make_shared<FilmOptions>();
  CLI::App* command = app.add_subcommand("film", "Make a film of frames that are there as PNG");
  command
      ->add_option(
          "frames", o->frames,
          "PNG files: a pattern ('out/%04d.png'), a folder, or the files in this order; what is missing is left "
          "out with a warning")
      ->type_name("FRAMES");
  command->add_option("-o,--output", o->output, "Film to write (.mp4, .mov, .mkv or .webm), through ffmpeg")
      ->type_name("FILE");
  command->add_option("--fps", o->fps, "Frames per second: 24, 23.976, 30000/1001")
      ->capture_default_str()
      ->type_name("RATE");
  command
      ->add_option("--frames", o->list, "Only these of a pattern or folder, in this order: 0-249, 1-100x5 or 2,4,10-20")
      ->type_name("LIST");
  add_codec_options(*command, o->film.codec, o->film.pad, o->audio);
  add_decode_budget(*command);
  command->add_flag("--quiet", o->quiet, "Only warnings and errors on stderr");
  command->callback([o, &action] { action = [o] { return run_film(*o); }; });
}

}  // namespace candela::cli
