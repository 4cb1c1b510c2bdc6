#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "job/job.h"
#include "render/frame_names.h"

namespace candela {

// What a task may take of a machine.
struct FarmNeeds {
  int cpus = 4, memory_mb = 8192, gpus = 0, minutes = 0;  // minutes 0: as the engine says
};

// A film that several machines make: one `sequence` in shards. The one model behind all writers (writers.h); it lies in
// its folder as job.json, where `farm status` and `farm check` find it.
struct FarmJob {
  std::string name;                    // in queues: letters, digits and ._-
  std::filesystem::path folder;        // absolute: job.json, the engine's file, logs/, records/
  std::filesystem::path work;          // absolute: where commands run, so that relative names mean what they meant
  std::string program;                 // absolute
  std::vector<std::string> arguments;  // of `candela sequence`, with scene, frames and outputs, without the shard
  std::string scene;                   // for people
  std::string frames;                  // the list as written
  std::string fps;
  std::vector<std::string> outputs;  // patterns
  std::string video, audio;          // the film that is made at the end; empty: none
  std::string video_codec = "auto";  // as FilmFile has them
  bool video_pad = false;
  int shards = 1;
  int rounds = 3;  // how often a shard is tried
  FarmNeeds needs;
  std::vector<std::string> engine_options;  // as the engine has them, "partition=night"
  Job job;                                  // decides the pictures

  FrameList frame_list() const;
  // The files of a frame, absolute.
  std::vector<std::filesystem::path> files(int64_t frame) const;
  FrameRate rate() const;
  // `work` as seen from the folder where that lies in it, so that machines may mount both elsewhere; else absolute.
  std::filesystem::path work_from_folder() const;
};

std::filesystem::path farm_job_file(const std::filesystem::path& folder);
std::filesystem::path farm_records(const std::filesystem::path& folder);
std::string farm_job_json(const FarmJob& job);
Expected<FarmJob> read_farm_job(const std::filesystem::path& folder);
// Makes the folder with logs/ and records/ and puts job.json there. Error (usage): another job is there.
Expected<void> write_farm_job(const FarmJob& job);

}  // namespace candela
