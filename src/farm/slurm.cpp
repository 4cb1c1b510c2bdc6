#include "base/text.h"
#include "farm/quote.h"
#include "farm/writers.h"

namespace candela {
namespace {

// "partition=night" or "exclusive", without the dashes. The file is bash as well, where these lines are comments.
// sbatch takes what stands between quotes of one kind as it is, but for backslashes.
Expected<std::string> option_line(const std::string& option) {
  const size_t equals = option.find('=');
  const std::string name = option.substr(0, equals), value = equals == option.npos ? "" : option.substr(equals + 1);
  const bool named = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  }) && name[0] != '-';
  const char quote = value.find('\'') == value.npos ? '\'' : '"';
  if (!named || value.find_first_of("\n\r\\") != value.npos || value.find(quote) != value.npos)
    return fail(ErrorKind::usage, "--slurm", "'{}' is not an option of sbatch; write NAME=VALUE, without the dashes",
                comment_text(option));
  for (const char* ours : {"array", "chdir", "dependency", "error", "exclude", "job-name", "mem", "open-mode", "output",
                           "parsable", "requeue", "wrap"})
    if (name == ours) return fail(ErrorKind::usage, "--slurm", "--{} is the job's own", name);
  if (equals == option.npos) return "#SBATCH --" + name + "\n";
  if (shell_quoted(value) == value) return "#SBATCH --" + option + "\n";
  return fmt::format("#SBATCH --{}={}{}{}\n", name, quote, value, quote);
}

// Where this machine sees the job. In a task $0 is Slurm's copy of the file; sbatch hands CANDELA_FOLDER on to it.
constexpr std::string_view slurm_folder = R"BASH(
file=$(cd -- "$(dirname -- "$0")" && pwd)/$(basename -- "$0")
folder=${CANDELA_FOLDER:-${file%/*}}
if [[ -z ${CANDELA_FOLDER:-} && ! -e $folder/job.json ]]; then folder=$written_to; fi
export CANDELA_FOLDER=$folder
)BASH";

// Behind the variables. Nothing in it depends on the job.
constexpr std::string_view slurm_body = R"BASH(
# What Slurm itself says of a task. It replaces %A in the whole path; a backslash keeps it from replacing anything, and
# then all tasks write to one file.
case $folder in
  *\\*) slurm_log=${folder//\\/\\\\}/logs/slurm.log ;;
  *) slurm_log=${folder//%/%%}/logs/slurm-%A_%a.log ;;
esac

say() { printf '%s\n' "$*" >&2; }

# Submits the shards (1,2,3...) as arrays no longer than the cluster takes, and prints the numbers of the jobs.
submit_shards() {  # ROUND MEMORY_MB SHARDS SBATCH_OPTION...
  local round=$1 memory=$2 most at job
  local -a all list
  IFS=, read -ra all <<<"$3"
  shift 3
  most=$(scontrol show config | sed -n 's/^MaxArraySize *= *//p')
  most=${most:-1001}
  if ((most > 5000)); then most=5000; fi  # the list goes along as one argument
  for ((at = 0; at < ${#all[@]}; at += most)); do
    list=("${all[@]:at:most}")
    job=$(sbatch --parsable --array="0-$((${#list[@]} - 1))" --mem="${memory}M" --chdir="$folder" --requeue \
      --open-mode=append --output="$slurm_log" "$@" \
      "$file" shard "$round" "$(IFS=,; printf '%s' "${list[*]}")") || return 1
    printf '%s\n' "${job%%;*}"
  done
}

# Submits the task that looks at the frames once these jobs have ended, however they did.
submit_check() {  # ROUND JOB...
  local round=$1 IFS=:
  shift
  sbatch --parsable --dependency="afterany:$*" --mem="${memory_mb}M" --chdir="$folder" --requeue \
    --open-mode=append --output="$slurm_log" "$file" check "$round"
}

submit() {
  local jobs check
  if ! jobs=$(submit_shards 1 "$memory_mb" "$(seq -s, 1 "$shards")") || ! check=$(submit_check 1 $jobs); then
    say "sbatch refused the job"
    if [[ -n $jobs ]]; then scancel $jobs; fi
    exit 1
  fi
  say "submitted $shards shards as" $jobs "and the check as $check"
}

run_shard() {  # ROUND SHARDS
  local round=$1 shard
  local -a list
  IFS=, read -ra list <<<"$2"
  shard=${list[SLURM_ARRAY_TASK_ID]}
  exec >>"$folder/logs/shard-$shard.log" 2>&1
  say "--- round $round on ${SLURMD_NODENAME:-?}, job ${SLURM_JOB_ID:-?}, $(date -u +%FT%TZ)"
  cd -- "$work"
  unset CANDELA_VIDEO CANDELA_VIDEO_CODEC CANDELA_VIDEO_PAD CANDELA_AUDIO  # the film is made at the end
  exec "$candela" sequence "${sequence[@]}" --shard "$shard/$shards" --resume --record "$folder/records"
}

# Frames that are not there, and what to do: candela farm check prints a line for each remedy,
#   again|never EXCLUDED_NODES|- MEMORY_FACTOR SHARDS
# by how the last run of a shard ended: 2, 3 and 7 never again; 4 (device) on other nodes; 6 (memory), and what was
# killed without a word, with more memory; all else again.
check() {  # ROUND
  local round=$1 todo status=0 what excluded factor list more jobs=
  exec >>"$folder/logs/check.log" 2>&1
  say "--- check after round $round on ${SLURMD_NODENAME:-?}, job ${SLURM_JOB_ID:-?}, $(date -u +%FT%TZ)"
  cd -- "$work"
  todo=$("$candela" farm check "$folder" --lost-after 0) || status=$?
  if ((status != 1)); then exit "$status"; fi
  if ((round >= rounds)); then
    say "frames are missing after $rounds rounds"
    exit 1
  fi
  while read -r what excluded factor list; do
    if [[ $what != again ]]; then continue; fi
    say "round $((round + 1)): shards $list, excluded nodes $excluded, memory x $factor"
    # Without the exclusion where there is no other node.
    if { [[ $excluded != - ]] &&
      more=$(submit_shards $((round + 1)) $((memory_mb * factor)) "$list" --exclude="$excluded"); } ||
      more=$(submit_shards $((round + 1)) $((memory_mb * factor)) "$list"); then
      jobs+=" $more"
    else
      say "sbatch refuses shards $list"
    fi
  done <<<"$todo"
  if [[ -z $jobs ]]; then exit 1; fi
  submit_check $((round + 1)) $jobs
}

case ${1:-submit} in
  submit) submit ;;
  shard) run_shard "$2" "$3" ;;
  check) check "$2" ;;
  *) say "unknown: $1"; exit 2 ;;
esac
)BASH";

}  // namespace

Expected<std::vector<FarmFile>> slurm_file(const FarmJob& job) {
  const std::string file = (job.folder / "job.sbatch").string();
  std::string text = "#!/bin/bash\n";
  text += fmt::format("# {} frames of {} in {} shards, by Slurm. Written by candela farm slurm.\n#\n",
                      job.frame_list().size(), comment_text(job.scene), job.shards);
  text += fmt::format("#   bash {}\n#\n", comment_text(shell_quoted(file)));
  text +=
      "# submits it: arrays over the shards, and a task that looks at the frames when those have ended, submits what "
      "is\n"
      "# missing once more and makes the film. Frames that are there and whole are never rendered twice, so the same\n"
      "# command goes on with a job that was cancelled.\n";
  text += "#SBATCH --job-name=" + job.name + "\n";
  text += fmt::format("#SBATCH --ntasks=1 --cpus-per-task={}\n", job.needs.cpus);
  if (job.needs.gpus > 0) text += fmt::format("#SBATCH --gres=gpu:{}\n", job.needs.gpus);
  if (job.needs.minutes > 0) text += fmt::format("#SBATCH --time={}\n", job.needs.minutes);
  const bool timed = job.needs.minutes > 0 || std::ranges::any_of(job.engine_options, [](const std::string& option) {
                       return option.starts_with("time=");
                     });
  if (!timed)
    log::warning("no --minutes: the cluster's own time limit holds for a shard, which may be short or refuse the job");
  for (const std::string& option : job.engine_options) {
    const auto line = option_line(option);
    if (!line) return std::unexpected(line.error());
    text += *line;
  }
  text += "set -euo pipefail\n\n";
  text += "# CANDELA_FOLDER, CANDELA_PROGRAM and CANDELA_SCENE say where the nodes see these, if elsewhere.\n";
  text += "written_to=" + shell_quoted(job.folder.string());
  text += slurm_folder;
  text += path_settings(job);
  text += fmt::format("shards={}\nrounds={}  # how often a shard is tried\nmemory_mb={}\n", job.shards, job.rounds,
                      job.needs.memory_mb);
  text += "sequence=(\"$scene\"\n" + argument_lines(words_after_scene(job), "  ", "") + ")\n";
  text += slurm_body;
  return std::vector<FarmFile>{{"job.sbatch", text}};
}

}  // namespace candela
