#pragma once
#include <set>
#include <string>
#include <vector>

#include "cli/job_options.h"
#include "cli/trace_options.h"
#include "render/sequence.h"

namespace candela::cli {

// What `sequence` takes, as text until all is read.
struct SequenceOptions {
  JobOptions job;
  TraceOptions tracing;  // of --technique reference
  std::string frames, shard = "1/1", video, video_codec = "auto", audio, timings, trace, record, devices, worker;
  std::vector<std::string> outputs;
  bool resume = false, video_pad = false;
  int in_flight = 0, encoders = 0;
  std::string cache = "auto";
};

// Those that say which frames are made and how; `farm` takes them too. What belongs to one run is `sequence`'s alone.
void add_film_options(CLI::App& command, SequenceOptions& options);

// --video-codec, --video-pad and --audio.
void add_codec_options(CLI::App& command, std::string& codec, bool& pad, std::string& audio);

// The list as written, or the turn that stands for it; empty where neither is given.
std::string frames_text(const SequenceOptions& options);
// The words that give another candela the options that were given here, by the command line, a file or the environment,
// but for `without`.
std::vector<std::string> given_words(const CLI::App& command, const std::set<std::string>& without);
// What a film shows and who makes it: the GPU, or, where it is traced, the reference.
struct FilmJob {
  Job job;
  std::optional<TraceRequest> traced;
};
// Checked. Options that belong to the other maker are errors (usage).
// Puts numbers for --frames all.
Expected<FilmJob> film_job(const CLI::App& command, SequenceOptions& options);
// Checked, but for folders and files that are written.
Expected<SequenceSettings> read_sequence(const SequenceOptions& options, const Job& job);

// sequence --devices: a process a device over one list of frames.
Expected<int> run_on_devices(CLI::App& command, SequenceOptions& options);

}  // namespace candela::cli
