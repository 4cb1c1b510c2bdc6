#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "base/files.h"
#include "base/json.h"
#include "base/log.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/progress.h"
#include "cli/sequence_options.h"
#include "cli/signals.h"
#include "gpu/device.h"
#include "render/shared_frames.h"
#include "session/timings.h"

extern char** environ;

namespace candela::cli {
namespace {

// The list of frames has this number in a worker.
constexpr int list_file = 3;

struct Worker {
  std::string device;
  pid_t process = -1;  // -1: it is not running
  int code = 0;        // of its last end
  bool lost = false;   // it is not started again
};

// What --device takes, by commas. all: every GPU; where there is none, every device.
Expected<std::vector<std::string>> devices_of(const std::string& text) {
  if (text != "all") return split(text, ',');
  const auto devices = gpu::list_devices();
  if (!devices) return std::unexpected(devices.error());
  std::vector<std::string> gpus, others;
  for (const gpu::DeviceInfo& device : *devices)
    if (device.unusable.empty()) (device.type == "cpu" ? others : gpus).push_back(fmt::format("{}", device.index));
  if (gpus.empty()) gpus = others;
  if (gpus.empty()) return fail(ErrorKind::device, "--devices", "there is no usable Vulkan device");
  return gpus;
}

Expected<void> check_options(const SequenceOptions& o) {
  const auto refuse = [](const char* option, const char* why) {
    return fail(ErrorKind::usage, "--devices", "does not go with {}: {}", option, why);
  };
  if (!o.job.device.empty()) return refuse("--device", "both choose the device");
  if (!o.video.empty())
    return refuse("--video",
                  "a film is made by one process, in order; write PNG files, and make it of them by candela film");
  if (!o.timings.empty() || !o.trace.empty()) return refuse("--timings and --trace", "they describe one device");
  return {};
}

class Workers {
 public:
  Workers(std::vector<std::string> words, const std::vector<std::string>& devices, SharedFrames& frames, size_t total,
          bool quiet)
      : words_(std::move(words)), frames_(frames), total_(total), progress_(quiet) {
    for (const std::string& device : devices) workers_.push_back({.device = device});
  }
  ~Workers() {
    for (Worker& worker : workers_)
      if (worker.process > 0) {
        kill(worker.process, SIGKILL);
        waitpid(worker.process, nullptr, 0);
      }
  }

  // 0, the code of the worker that ended all, or that of a signal.
  Expected<int> run(const std::atomic<int>& stop) {
    const double start_us = process_clock_us();
    for (;;) {
      const bool ending = stop != 0 || fatal_ != 0;
      if (ending) signal_all(stop != 0 ? int(stop) : SIGTERM);
      if (!ending && frames_.counts().free > 0)
        for (size_t i = 0; i < workers_.size(); ++i)
          if (workers_[i].process < 0 && !workers_[i].lost)
            if (auto started = start(i); !started) return std::unexpected(started.error());
      const bool running = collect();
      report(start_us);
      if (!running && (ending || frames_.counts().free == 0 || all_lost())) break;
      constexpr int patience_ms = 50;
      poll(nullptr, 0, patience_ms);
    }
    progress_.end();
    if (stop != 0) return 128 + stop;
    if (fatal_ != 0) return fatal_;
    return frames_.counts().done() == total_ ? 0 : last_code_;
  }

 private:
  Expected<void> start(size_t i) {
    std::vector<std::string> words = {(program_folder() / "candela").string(), "sequence"};
    words.insert(words.end(), words_.begin(), words_.end());
    words.push_back("--device=" + workers_[i].device);
    words.push_back(fmt::format("--worker={}:{}", list_file, i));
    words.push_back("--quiet");
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&files, frames_.file(), list_file);
    // A group of its own: an interrupt at the terminal is this process's to hand on.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    const int error = posix_spawn(&workers_[i].process, pointers[0], &files, &attributes, pointers.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    if (error == 0) return {};
    workers_[i].process = -1;
    return fail(ErrorKind::out_of_memory, words[0], "cannot be started: {}", std::strerror(error));
  }

  // Sees who has ended; true while any runs.
  bool collect() {
    bool running = false;
    for (size_t i = 0; i < workers_.size(); ++i) {
      Worker& worker = workers_[i];
      int status = 0;
      if (worker.process > 0 && waitpid(worker.process, &status, WNOHANG) == worker.process) {
        worker.process = -1;
        worker.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        frames_.release(i);
        judge(worker);
      }
      running |= worker.process > 0;
    }
    return running;
  }

  // What would end alike on every device, or for want of room for files, ends all.
  void judge(Worker& worker) {
    if (worker.code == 0 || fatal_ != 0) return;
    last_code_ = worker.code;
    worker.lost = true;
    if (worker.code == int(ErrorKind::device) || worker.code == int(ErrorKind::out_of_memory) || worker.code > 128)
      log::warning("the worker on device {} ended with {}; its frames go to the others", worker.device, worker.code);
    else
      fatal_ = worker.code;
  }

  bool all_lost() const {
    return std::all_of(workers_.begin(), workers_.end(), [](const Worker& worker) { return worker.lost; });
  }

  void signal_all(int signal) {
    if (std::exchange(signalled_, true)) return;
    for (const Worker& worker : workers_)
      if (worker.process > 0) kill(worker.process, signal);
  }

  void report(double start_us) {
    const SharedFrames::Counts counts = frames_.counts();
    if (counts.done() == reported_) return;
    reported_ = counts.done();
    SequenceProgress p{.done = counts.done(), .skipped = counts.skipped, .total = total_};
    if (const double passed_s = (process_clock_us() - start_us) * 1e-6; counts.rendered > 0 && passed_s > 0) {
      p.frames_per_s = double(counts.rendered) / passed_s;
      p.left_s = double(p.total - p.done) / p.frames_per_s;
    }
    progress_.show(p);
  }

  std::vector<std::string> words_;
  std::vector<Worker> workers_;
  SharedFrames& frames_;
  size_t total_, reported_ = 0;
  ProgressLine progress_;
  int fatal_ = 0, last_code_ = int(ErrorKind::device);
  bool signalled_ = false;
};

Expected<void> print_result(const SequenceOptions& o, const std::vector<std::string>& devices,
                            const SharedFrames::Counts& counts) {
  nlohmann::ordered_json j;
  j["version"] = CANDELA_VERSION;
  j["devices"] = devices;
  j["outputs"] = o.outputs;
  j["frames"] = frames_text(o);
  j["shard"] = o.shard;
  j["fps"] = o.job.fps;
  j["rendered"] = counts.rendered;
  j["skipped"] = counts.skipped;
  return print_json(j);
}

}  // namespace

Expected<int> run_on_devices(CLI::App& command, SequenceOptions& o) {
  if (auto good = check_options(o); !good) return std::unexpected(good.error());
  const auto film = film_job(command, o);
  if (!film) return std::unexpected(film.error());
  const auto settings = read_sequence(o, film->job);
  if (!settings) return std::unexpected(settings.error());
  if (auto good = check_sequence(*settings); !good) return std::unexpected(good.error());
  const auto devices = devices_of(o.devices);
  if (!devices) return std::unexpected(devices.error());
  if (devices->size() > SharedFrames::most_workers)
    return fail(ErrorKind::usage, "--devices", "{} are more than {}", devices->size(), SharedFrames::most_workers);
  const auto frames = SharedFrames::create(settings->frames.size());
  if (!frames) return std::unexpected(frames.error());
  HeldSignals held;
  Workers workers(given_words(command, {"devices", "device", "json", "quiet", "config"}), *devices, **frames,
                  settings->frames.size(), o.job.quiet);
  const auto code = workers.run(held.pending());
  if (!code) return std::unexpected(code.error());
  const SharedFrames::Counts counts = (*frames)->counts();
  if (*code != 0) {
    log::error("{} of {} frames are there; the same command with --resume goes on", counts.done(),
               settings->frames.size());
    return *code;
  }
  log::info("{} frames rendered, {} were there, by {} devices", counts.rendered, counts.skipped, devices->size());
  if (o.job.json)
    if (auto printed = print_result(o, *devices, counts); !printed) return std::unexpected(printed.error());
  return 0;
}

}  // namespace candela::cli
