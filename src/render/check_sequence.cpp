#include <algorithm>
#include <set>

#include "base/file_uses.h"
#include "render/film_frames.h"
#include "render/sequence.h"
#include "render/video.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

// Of longer films the files are told by their patterns, so that neither memory nor the time before the first frame
// grows with the number of frames.
constexpr size_t most_named_frames = 100'000;

Error twice(const std::string& name) {
  return {ErrorKind::usage, fmt::format("'{}' would be written twice", name), "-o"};
}

Expected<void> check_two(const FramePattern& a, const FramePattern& b, const FrameList& frames) {
  if (!a.numbered || !b.numbered) {
    if (fs::path(a.name(frames[0])).lexically_normal() == fs::path(b.name(frames[0])).lexically_normal())
      return std::unexpected(twice(a.name(frames[0])));
    return {};
  }
  if (!may_share_names(a, b)) return {};
  for (const int64_t frame : frames)
    if (const auto other = b.frame_of(a.name(frame)); other && frames.contains(*other))
      return std::unexpected(twice(a.name(frame)));
  return {};
}

Expected<void> declare_files(const SequenceSettings& settings) {
  if (!settings.film.audio.empty()) note_read({"--audio", settings.film.audio});
  std::vector<NamedFile> files;
  if (settings.frames.size() <= most_named_frames) {
    for (const int64_t frame : settings.frames)
      for (const FramePattern& pattern : settings.patterns) files.push_back({"-o", pattern.name(frame)});
  } else {
    const auto holds = [patterns = settings.patterns, frames = settings.frames](const fs::path& file) {
      return std::ranges::any_of(patterns, [&](const FramePattern& pattern) {
        const fs::path folder = fs::path(pattern.name(0)).parent_path();
        if (links_followed(folder) != file.parent_path()) return false;
        const auto frame = pattern.frame_of(folder / file.filename());
        return frame && frames.contains(*frame);
      });
    };
    if (auto fine = declare_outputs("-o", holds); !fine) return fine;
  }
  if (!settings.film.path.empty()) files.push_back({"--video", settings.film.path});
  return declare_outputs(files);
}

}  // namespace

std::set<fs::path> folders_of(const SequenceSettings& settings) {
  std::set<fs::path> folders;
  std::vector<FramePattern> patterns = settings.patterns;
  if (settings.kept) patterns.push_back(*settings.kept);
  for (const FramePattern& pattern : patterns)
    if (pattern.before_number() != pattern.name(0) && pattern.after_number().find('/') == std::string::npos)
      folders.insert(fs::path(pattern.name(0)).parent_path());
    else
      for (const int64_t frame : settings.frames) folders.insert(fs::path(pattern.name(frame)).parent_path());
  return folders;
}

Expected<void> check_sequence(const SequenceSettings& settings) {
  if (settings.patterns.empty() && settings.film.path.empty())
    return fail(ErrorKind::usage, "-o", "no output given; name files such as 'out/%04d.exr', or --video FILE.mp4");
  if (settings.frames.empty())
    return fail(ErrorKind::usage, "--shard", "there are fewer frames than shards: this shard has none");
  for (const FramePattern& pattern : settings.patterns) {
    if (pattern.by_camera)
      return fail(ErrorKind::usage, "-o", "'{}': {{camera}} belongs to render, a sequence has one", pattern.given);
    if (!pattern.numbered && settings.frames.size() > 1)
      return fail(ErrorKind::usage, "-o", "'{}' has no place for the frame number; write %04d or ####", pattern.given);
    if (const auto format = output_format(pattern.name(0)); !format) return std::unexpected(format.error());
  }
  for (size_t i = 0; i < settings.patterns.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (auto fine = check_two(settings.patterns[j], settings.patterns[i], settings.frames); !fine) return fine;
  if (auto fine = declare_files(settings); !fine) return fine;
  SequenceSettings named = settings;
  named.kept.reset();
  for (const fs::path& folder : folders_of(named))
    for (const FramePattern& pattern : settings.patterns)
      if (const fs::path first = pattern.name(settings.frames[0]); first.parent_path() == folder) {
        if (auto ready = prepare_output(first); !ready) return ready;
      } else if (pattern.after_number().find('/') != std::string::npos) {
        if (auto ready = prepare_output(folder / first.filename()); !ready) return ready;
      }
  if (!settings.film.path.empty()) {
    if (auto good = check_video(settings.film); !good) return good;
  } else if (!settings.film.audio.empty()) {
    return fail(ErrorKind::usage, "--audio", "goes with --video");
  }
  return {};
}

WantedOutputs wanted_by(const SequenceSettings& settings, const Job& job) {
  WantedOutputs wanted{
      .linear = false, .display = !settings.film.path.empty(), .display_bits = job.png_bits, .files = true};
  for (const FramePattern& pattern : settings.patterns) {
    const auto format = output_format(pattern.name(0));
    (format && *format == OutputFormat::exr ? wanted.linear : wanted.display) = true;
  }
  return wanted;
}

}  // namespace candela
