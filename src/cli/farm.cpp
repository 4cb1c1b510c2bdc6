#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <map>

#include "base/file_uses.h"
#include "base/files.h"
#include "base/json.h"
#include "base/log.h"
#include "base/stale_files.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/progress.h"
#include "cli/sequence_options.h"
#include "farm/farm_state.h"
#include "farm/film.h"
#include "farm/quote.h"
#include "farm/writers.h"
#include "gltf/gltf.h"
#include "gpu/device.h"
#include "render/film_frames.h"

extern char** environ;

namespace candela::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Writer = Expected<std::vector<FarmFile>> (*)(const FarmJob&);

struct FarmOptions {
  SequenceOptions sequence;
  std::string folder, name, program;
  int shards = 0, rounds = 3;
  FarmNeeds needs;
  std::vector<std::string> engine_options;
  bool submit = false;
};

// As many frames to a shard as make opening the device and the scene small beside them, and as many shards as an array
// of Slurm holds by default.
int shards_for(size_t frames) {
  constexpr size_t frames_a_shard = 8, most = 1000;
  return int(std::clamp<size_t>((frames + frames_a_shard - 1) / frames_a_shard, 1, most));
}

// A film is made of PNG files: where none are written, in the job's folder.
Expected<void> give_film_frames(FarmJob& job) {
  if (job.video.empty() || film_output(job.outputs) >= 0) return {};
  // By a relative name where there is one: machines may mount the folder elsewhere.
  const fs::path inside = job.folder.lexically_relative(job.work);
  const bool below = !inside.empty() && *inside.begin() != "..";
  std::string folder = ((below ? inside : job.folder) / "film").string();
  if (folder.starts_with('-')) folder = "./" + folder;
  std::string pattern;
  for (const char c : folder)
    pattern += std::string(std::string_view("%{}").find(c) == std::string_view::npos ? 1 : 2, c);
  pattern += "/%06d.png";
  const auto read = parse_pattern(pattern);
  if (!read || read->name(7) != folder + "/000007.png")
    return fail(ErrorKind::usage, "--job",
                "the frames of the film go there, and its name holds a place for their number");
  job.outputs.push_back(pattern);
  job.arguments.insert(job.arguments.end(), {"--output", pattern});
  return {};
}

// What was made with a GPU in mind does not fall to the CPU on a machine without one: it ends there with exit 4, and
// engines try it elsewhere.
void keep_to_gpu(FarmJob& job, const JobOptions& o) {
  if (!o.device.empty() || o.allow_cpu) return;
  const auto is_gpu = [](const gpu::DeviceInfo& device) { return !device.is_cpu && device.unusable.empty(); };
  const auto devices = gpu::list_devices();
  if (o.strict.empty() && !(devices && std::any_of(devices->begin(), devices->end(), is_gpu))) return;
  job.arguments.insert(job.arguments.end(), {"--device", "gpu"});
  log::info("machines without a GPU end with exit 4 (--allow-cpu lets them use the CPU)");
}

Expected<FarmJob> farm_job(CLI::App& command, FarmOptions& o, const std::set<std::string>& own) {
  SequenceOptions& s = o.sequence;
  if (auto read = read_config(command, s.job.config); !read) return std::unexpected(read.error());
  set_log_level(s.job);
  const auto film = film_job(command, s);
  if (!film) return std::unexpected(film.error());
  const Job* decided = &film->job;
  if (auto settings = run_settings_of(s.job); !settings) return std::unexpected(settings.error());
  if (decided->timings_in_metadata)
    return fail(ErrorKind::usage, "--metadata-timings",
                "does not go with farms, where a frame is the same from anywhere");
  FarmJob job;
  job.scene = s.job.scene;
  const std::string stem = fs::path(job.scene).stem().string();
  job.name = plain_name(o.name.empty() ? stem : o.name);
  job.work = fs::current_path();
  job.folder = fs::absolute(o.folder.empty() ? stem + ".farm" : o.folder).lexically_normal();
  job.program = o.program.empty() ? (program_folder() / "candela").string() : fs::absolute(o.program).string();
  job.frames = frames_text(s);
  job.fps = s.job.fps;
  job.outputs = s.outputs;
  job.video = s.video;
  job.audio = s.audio;
  job.video_codec = s.video_codec;
  job.video_pad = s.video_pad;
  job.rounds = o.rounds;
  job.needs = o.needs;
  job.engine_options = o.engine_options;
  job.job = *decided;
  job.arguments = given_words(command, own);
  if (s.job.png_bits != JobOptions().png_bits && command.get_option("--png-bits")->count() == 0)
    job.arguments.insert(job.arguments.end(), {"--png-bits", fmt::format("{}", s.job.png_bits)});  // the film's codec
  if (!film->traced) keep_to_gpu(job, s.job);
  if (auto given = give_film_frames(job); !given) return std::unexpected(given.error());
  s.outputs = job.outputs;
  note_scene_files(job.scene);
  const auto settings = read_sequence(s, *decided);
  if (!settings) return std::unexpected(settings.error());
  if (auto good = check_sequence(*settings); !good) return std::unexpected(good.error());
  job.shards = o.shards > 0 ? o.shards : shards_for(settings->frames.size());
  if (size_t(job.shards) > settings->frames.size())
    return fail(ErrorKind::usage, "--shards", "{} shards are more than the {} frames", job.shards,
                settings->frames.size());
  return job;
}

bool is_on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  return std::ranges::any_of(split(path ? path : "", ':'), [&](const std::string& folder) {
    return access((fs::path(folder) / program).c_str(), X_OK) == 0;
  });
}

Expected<void> submit(const fs::path& file) {
  if (!is_on_path("sbatch"))
    return fail(ErrorKind::usage, "--submit",
                "there is no Slurm here (no program sbatch on PATH); run `bash {}` on a machine that has it",
                shell_quoted(file.string()));
  std::string program = "bash", path = file.string();
  char* words[] = {program.data(), path.data(), nullptr};
  pid_t process = -1;
  if (const int error = posix_spawnp(&process, "bash", nullptr, nullptr, words, environ); error != 0)
    return fail(ErrorKind::device, path, "cannot start bash: {}", std::strerror(error));
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  return fail(ErrorKind::device, path, "could not be submitted (the reason is above)");
}

Expected<int> run_writer(CLI::App& command, FarmOptions& o, const std::set<std::string>& own, Writer writer) {
  const auto job = farm_job(command, o, own);
  if (!job) return std::unexpected(job.error());
  const auto files = writer(*job);
  if (!files) return std::unexpected(files.error());
  if (auto fine = check_outputs(); !fine) return std::unexpected(fine.error());
  if (auto written = write_farm_job(*job); !written) return std::unexpected(written.error());
  for (const FarmFile& file : *files)
    if (auto written = write_file_atomically(job->folder / file.name, file.text); !written)
      return std::unexpected(written.error());
  const fs::path path = job->folder / files->front().name;
  log::info("{} frames in {} shards", job->frame_list().size(), job->shards);
  if (auto printed = print(path.string() + "\n"); !printed) return std::unexpected(printed.error());
  if (!o.submit) return 0;
  if (auto submitted = submit(path); !submitted) return std::unexpected(submitted.error());
  return 0;
}

struct StatusOptions {
  std::string folder;
  bool json = false, whole = false;
  double lost_after_s = 600;
};

// With the names of failed shards' last runs; schema: docs/schemas/farm-status.schema.json.
Json status_json(const FarmJob& job, const FarmState& state) {
  Json j;
  j["version"] = CANDELA_VERSION;
  j["name"] = job.name;
  j["complete"] = state.complete();
  j["frames"] = {{"total", state.frames},
                 {"done", state.done},
                 {"failed", state.failed},
                 {"missing", state.missing},
                 {"damaged", state.damaged}};
  std::map<ShardStage, size_t> count;
  for (const ShardState& shard : state.shards) ++count[shard.stage];
  j["shards"] = {{"total", state.shards.size()}};
  for (const ShardStage stage : {ShardStage::done, ShardStage::running, ShardStage::failed, ShardStage::waiting})
    j["shards"][stage_name(stage)] = count[stage];
  j["frames_per_s"] = state.rendered_per_s > 0 ? Json(state.rendered_per_s) : Json();
  j["seconds_left"] = state.rendered_per_s > 0 ? Json(state.seconds_left) : Json();
  j["devices"] = state.devices;
  j["failures"] = Json::array();
  for (const ShardState& shard : state.shards) {
    if (shard.stage != ShardStage::failed) continue;
    const RunRecord& last = shard.runs.back();
    const Remedy remedy = remedy_of(shard);
    j["failures"].push_back({{"shard", shard.index},
                             {"node", last.node},
                             {"code", last.code ? Json(*last.code) : Json()},
                             {"error", last.error},
                             {"runs", shard.runs.size()},
                             {"missing", shard.missing.size()},
                             {"remedy", remedy_name(remedy.kind)}});
  }
  return j;
}

// Frames as --frames takes them, cut where there are very many ranges.
std::string ranges_text(std::vector<int64_t> frames) {
  std::ranges::sort(frames);
  std::string text;
  constexpr size_t longest = 400;
  for (size_t i = 0; i < frames.size();) {
    size_t end = i + 1;
    while (end < frames.size() && frames[end] == frames[end - 1] + 1) ++end;
    if (text.size() > longest) return text + ",...";
    text += text.empty() ? "" : ",";
    text += end - i == 1 ? fmt::format("{}", frames[i]) : fmt::format("{}-{}", frames[i], frames[end - 1]);
    i = end;
  }
  return text;
}

// Which frames are missing and which damaged.
std::string frame_lines(const FarmState& state) {
  std::vector<int64_t> missing, damaged;
  for (const ShardState& shard : state.shards) {
    damaged.insert(damaged.end(), shard.damaged.begin(), shard.damaged.end());
    std::ranges::set_difference(shard.missing, shard.damaged, std::back_inserter(missing));
  }
  std::string text;
  if (!missing.empty()) text += "missing  " + ranges_text(std::move(missing)) + "\n";
  if (!damaged.empty()) text += "damaged  " + ranges_text(std::move(damaged)) + "\n";
  return text;
}

std::string status_text(const FarmState& state) {
  std::string text = fmt::format("frames   {} of {} done, {} failed, {} missing, {} damaged\n", state.done,
                                 state.frames, state.failed, state.missing, state.damaged);
  std::map<ShardStage, size_t> count;
  for (const ShardState& shard : state.shards) ++count[shard.stage];
  text += fmt::format("shards   {} of {} done, {} running, {} failed, {} waiting\n", count[ShardStage::done],
                      state.shards.size(), count[ShardStage::running], count[ShardStage::failed],
                      count[ShardStage::waiting]);
  if (state.rendered_per_s > 0)
    text += fmt::format("rate     {:.2f} frames/s{}\n", state.rendered_per_s,
                        state.complete() ? "" : ", " + duration_text(state.seconds_left) + " left");
  for (const std::string& device : state.devices) text += "device   " + device + "\n";
  std::vector<std::vector<std::string>> rows = {{"SHARD", "NODE", "CODE", "RUNS", "NEXT", "ERROR"}};
  for (const ShardState& shard : state.shards) {
    if (shard.stage != ShardStage::failed) continue;
    const RunRecord& last = shard.runs.back();
    rows.push_back({fmt::format("{}", shard.index), last.node, last.code ? fmt::format("{}", *last.code) : "killed",
                    fmt::format("{}", shard.runs.size()), remedy_name(remedy_of(shard).kind), last.error});
  }
  if (rows.size() > 1) text += table_text(rows);
  return text + frame_lines(state);
}

Expected<int> run_status(const StatusOptions& o) {
  const auto job = read_farm_job(o.folder);
  if (!job) return std::unexpected(job.error());
  const auto state =
      look_at_farm(*job, {.frames = o.whole ? FrameLook::whole : FrameLook::header, .lost_after_s = o.lost_after_s});
  if (!state) return std::unexpected(state.error());
  if (auto printed = o.json ? print_json(status_json(*job, *state)) : print(status_text(*state)); !printed)
    return std::unexpected(printed.error());
  return state->complete() ? 0 : int(ErrorKind::comparison);
}

// A line for each thing to be done: WHAT EXCLUDED_NODES|- MEMORY_FACTOR SHARDS.
std::string remedy_lines(const FarmState& state) {
  std::map<Remedy, std::vector<std::string>> shards;
  for (const ShardState& shard : state.shards)
    if (!shard.missing.empty()) shards[remedy_of(shard)].push_back(fmt::format("{}", shard.index));
  std::string text;
  for (const auto& [remedy, list] : shards) {
    const std::vector<std::string> nodes(remedy.exclude.begin(), remedy.exclude.end());
    text += fmt::format("{} {} {} {}\n", remedy_name(remedy.kind), nodes.empty() ? "-" : joined(nodes, ","),
                        remedy.memory_factor, joined(list, ","));
  }
  return text;
}

// What killed runs left.
void remove_stale_files(const FarmJob& job) {
  const FrameList frames = job.frame_list();
  std::set<fs::path> folders;
  for (const fs::path& file : job.files(frames[0])) folders.insert(file.parent_path());
  remove_stale_temporaries(folders, [&](const std::function<bool(const fs::path&)>& is_target) {
    for (const int64_t frame : frames)
      for (const fs::path& file : job.files(frame))
        if (is_target(file)) return;
  });
  std::vector<fs::path> others;
  if (!job.video.empty()) others.push_back(job.work / job.video);
  remove_stale_temporaries(others);
  // A run that was killed while it wrote its first record has none by whose name this could be found.
  remove_all_stale_temporaries(farm_records(job.folder));
}

Expected<int> run_check(const StatusOptions& o) {
  const auto job = read_farm_job(o.folder);
  if (!job) return std::unexpected(job.error());
  const auto state = look_at_farm(*job, {.frames = FrameLook::whole, .lost_after_s = o.lost_after_s});
  if (!state) return std::unexpected(state.error());
  if (!state->complete()) {
    log::error("{} of {} frames are not there or not whole", state->frames - state->done, state->frames);
    for (const std::string& line : split(frame_lines(*state), '\n'))
      if (!line.empty()) log::error("{}", line);
    if (auto printed = print(remedy_lines(*state)); !printed) return std::unexpected(printed.error());
    return int(ErrorKind::comparison);
  }
  log::info("all {} frames are there and whole", state->frames);
  if (state->devices.size() > 1)
    log::warning("different devices made them, so their last bits may differ: {}", joined(state->devices));
  remove_stale_files(*job);
  if (job->video.empty()) return 0;
  if (auto made = make_farm_film(*job); !made) return std::unexpected(made.error());
  log::info("film {}", (job->work / job->video).string());
  return 0;
}

std::set<std::string> names_of(const CLI::App& command) {
  std::set<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.insert(name);
  return names;
}

void add_writer(CLI::App& farm, const char* name, const char* help, Writer writer,
                const std::shared_ptr<FarmOptions>& o, Action& action) {
  CLI::App* command = farm.add_subcommand(name, help);
  command->add_option("--job", o->folder, "Folder of the job, which all machines see; by default SCENE.farm")
      ->type_name("DIR");
  command->add_option("--name", o->name, "Name of the job; by default the scene's")->type_name("NAME");
  command
      ->add_option("--shards", o->shards,
                   "How many parts the frames are divided into; 0: one for every 8 frames, at most 1000")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--rounds", o->rounds, "How many times a part is tried")
      ->check(CLI::Range(1, 100))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--cpus", o->needs.cpus, "Cores for a part")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--memory-mb", o->needs.memory_mb, "Memory for a part, MiB; doubled when it was not enough")
      ->check(CLI::Range(1, 1 << 26))
      ->capture_default_str()
      ->type_name("MIB");
  command->add_option("--gpus", o->needs.gpus, "GPUs for a part")
      ->check(CLI::Range(0, 64))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--minutes", o->needs.minutes, "Longest time for a part, in minutes; 0: the engine's own limit")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--program", o->program, "The candela program that the machines run; by default this one")
      ->type_name("FILE");
  if (writer == slurm_file) {
    command->add_option("--slurm", o->engine_options, "An option of sbatch, as partition=night; may be given again")
        ->allow_extra_args(false)
        ->type_name("NAME=VALUE");
    command->add_flag("--submit", o->submit, "Submit it");
  }
  std::set<std::string> own = names_of(*command);
  own.insert({"video", "video-codec", "video-pad", "audio", "config"});
  add_film_options(*command, o->sequence);
  add_run_options(*command, o->sequence.job);
  command->remove_option(command->get_option("--json"));
  command->callback([command, o, own, writer, &action] {
    action = [command, o, own, writer] { return run_writer(*command, *o, own, writer); };
  });
}

CLI::App* add_folder_command(CLI::App& farm, const char* name, const char* help,
                             const std::shared_ptr<StatusOptions>& o) {
  CLI::App* command = farm.add_subcommand(name, help);
  command->add_option("folder", o->folder, "Folder of the job")->required()->type_name("DIR");
  command->add_option("--lost-after", o->lost_after_s, "A run that has not been heard of for this long counts as dead")
      ->check(non_negative_number())
      ->capture_default_str()
      ->type_name("SECONDS");
  return command;
}

}  // namespace

void add_farm(CLI::App& app, Action& action) {
  CLI::App* farm =
      app.add_subcommand("farm", "Share a film among several machines, by Slurm, OpenCue, make or the shell");
  farm->require_subcommand(1);
  const auto writer = [&](const char* name, const char* help, Writer write) {
    add_writer(*farm, name, help, write, std::make_shared<FarmOptions>(), action);
  };
  writer("slurm", "Write a file for sbatch (docs/using/farm.md)", slurm_file);
  writer("opencue", "Write an outline for OpenCue (experimental)", opencue_files);
  writer("make", "Write a file for GNU make", make_file);
  writer("shell", "Write a shell script that any number of machines may run at the same time", shell_file);
  auto o = std::make_shared<StatusOptions>();
  CLI::App* status = add_folder_command(*farm, "status", "Say what is done, failed and missing, and the time left", o);
  status->add_flag("--whole", o->whole, "Check all bytes of each file, not only its header and its length");
  status->add_flag("--json", o->json, "As JSON");
  status->callback([o, &action] { action = [o] { return run_status(*o); }; });
  CLI::App* check = add_folder_command(
      *farm, "check",
      "Check that all frames are there and whole, then make the film; otherwise exit 1 and print what to do", o);
  check->callback([o, &action] { action = [o] { return run_check(*o); }; });
}

}  // namespace candela::cli
