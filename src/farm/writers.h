#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "farm/farm_job.h"

// What an engine reads, from the one model of a job (farm_job.h). The first file is the one that starts it.
namespace candela {

struct FarmFile {
  std::string name;  // in the job's folder
  std::string text;
};
// Assignments of sh and bash that set work, candela and scene, each as CANDELA_PROGRAM or CANDELA_SCENE says where that
// is set, so that machines may mount them elsewhere. $folder is set before.
std::string path_settings(const FarmJob& job, std::string_view end = "\n");
// The words behind the scene.
std::span<const std::string> words_after_scene(const FarmJob& job);

// job.sbatch: a file for sbatch that is also a shell script. It submits arrays over the shards and behind them a task
// that looks whether all frames are there, submits what is not, and makes the film.
Expected<std::vector<FarmFile>> slurm_file(const FarmJob& job);
// job.py and task.sh: an outline for OpenCue's pyoutline, and what its frames run.
Expected<std::vector<FarmFile>> opencue_files(const FarmJob& job);
// job.mk: a target for each shard, and the check behind them. Error (usage): a line break in a name.
Expected<std::vector<FarmFile>> make_file(const FarmJob& job);
// job.sh: for sh; every machine that runs it takes free shards.
Expected<std::vector<FarmFile>> shell_file(const FarmJob& job);

}  // namespace candela
