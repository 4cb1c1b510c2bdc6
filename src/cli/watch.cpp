#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "base/clock.h"
#include "base/file_uses.h"
#include "base/file_watch.h"
#include "base/log.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/job_options.h"
#include "cli/output_paths.h"
#include "cli/result.h"
#include "cli/scene_notes.h"
#include "cli/signals.h"
#include "gltf/losses.h"
#include "render/frame_names.h"
#include "render/outputs.h"
#include "render/picture_distance.h"
#include "render/watched_files.h"

namespace candela::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Files are whole when nothing has happened to them for so long; one that never rests is looked at all the same.
constexpr int rest_ms = 40, longest_unrest_ms = 2000;
// How long a signal waits while nothing happens.
constexpr int pause_ms = 100;

struct WatchOptions {
  JobOptions job;
  MomentOptions moment;
  std::vector<std::string> outputs;
  std::optional<int> pictures;
  bool pass_times = false;
};

// Passes that the frame has and the one before had not, and the other way round: "+ bloom, - fog".
std::string pass_changes(const std::set<std::string>& before, const std::set<std::string>& now) {
  std::vector<std::string> words;
  for (const std::string& name : now)
    if (!before.contains(name)) words.push_back("+ " + name);
  for (const std::string& name : before)
    if (!now.contains(name)) words.push_back("- " + name);
  constexpr size_t most = 6;
  const size_t more = words.size() > most ? words.size() - most : 0;
  words.resize(words.size() - more);
  return words.empty() ? "" : fmt::format(" ({}{})", joined(words), more ? fmt::format(" and {} more", more) : "");
}

// Warnings of textures, surfaces and lights that a picture lacks. Files that are not whole yet lead to such, and no
// picture of the watch is made worse by them than the one before.
std::set<std::string> losses_of(const std::vector<std::string>& scene, const std::vector<std::string>& frame) {
  std::set<std::string> losses;
  for (const std::vector<std::string>* warnings : {&scene, &frame})
    for (const std::string& warning : *warnings)
      if (tells_of_loss(warning)) losses.insert(warning);
  return losses;
}

// The longest of a timed frame: "; shade_forward 12.1 ms, resolve 3.4 ms".
std::string longest_passes(std::vector<gpu::PassTime> passes) {
  constexpr size_t most = 4;
  std::ranges::stable_sort(passes, std::greater<>(), &gpu::PassTime::gpu_ms);
  std::string text;
  for (size_t i = 0; i < std::min(most, passes.size()); ++i)
    text += fmt::format("{} {} {:.3g} ms", i == 0 ? ";" : ",", passes[i].name, passes[i].gpu_ms);
  return text;
}

class Watch {
 public:
  Watch(const WatchOptions& options, Job job, Moment moment, RunSettings settings)
      : o_(options), job_(std::move(job)), moment_(std::move(moment)), settings_(std::move(settings)) {}

  // Names the outputs, and renders the first picture.
  Expected<void> begin() {
    wanted_ = {.linear = false, .display = true, .display_bits = job_.png_bits};
    for (const std::string& output : o_.outputs) {
      const auto format = output_format(output);
      if (!format) return std::unexpected(format.error());
      wanted_.linear |= *format == OutputFormat::exr;
    }
    if (auto good = check_layers(job_, wanted_.linear); !good) return good;
    auto paths = output_paths(o_.outputs, moment_.frame.value_or(0));
    if (!paths) return std::unexpected(paths.error());
    paths_ = std::move(*paths);
    std::vector<NamedFile> named;
    for (const fs::path& path : paths_) named.push_back({"-o", path});
    if (auto fine = declare_outputs(named); !fine) return fine;
    for (const fs::path& path : paths_)
      if (auto ready = prepare_output(path); !ready) return ready;
    auto watch = FileWatch::open();
    if (!watch) return std::unexpected(watch.error());
    watch_.emplace(std::move(*watch));
    const auto begin = Clock::now();
    begun_ = fs::file_time_type::clock::now();
    JobFiles first{.scene = {job_.scene}, .shader_folder = settings_.shader_folder};
    if (!job_.look.empty()) first.look.emplace_back(job_.look);
    files_.take(first, begun_);
    watch_->set(files_.files(), files_.folders());
    if (auto opened = open(); !opened) return opened;
    log_device(session_->device().info());
    note_fall_to_cpu(session_->device().info(), o_.job, false);
    if (auto noted = note_scene(session_->scene(), strictness(o_.job.strict)); !noted) return noted;
    if (auto drawn = draw(begin, "opened"); !drawn) return drawn;
    take_files();
    return {};
  }

  // Until a signal comes, or as many pictures were made as were asked for.
  Expected<int> run(const std::atomic<int>& signal) {
    while (signal == 0 && !(o_.pictures && pictures_ >= *o_.pictures)) {
      const bool any = !refused_.empty();  // what a file names may be what is missing
      if (!std::exchange(look_once_, false) && !watch_->wait(pause_ms, any) && !watch_->find_missing()) continue;
      const auto begin = Clock::now();
      while (signal == 0 && ms_since(begin) < longest_unrest_ms && watch_->wait(rest_ms, any)) {
      }
      watch_->find_missing();
      if (signal == 0)
        if (auto looked = look_again(begin); !looked) return std::unexpected(looked.error());
    }
    return 0;
  }

 private:
  Expected<void> open() {
    auto session = Session::open(job_, wanted_, settings_);
    if (!session) return std::unexpected(session.error());
    if (session_) (*session)->take_trees(*session_);
    session_ = std::move(*session);
    return {};
  }

  // What was written before its folder was watched has told nothing: it is looked at once.
  void take_files() {
    files_.take(files_of(job_, session_->scene(), settings_.shader_folder, begun_), begun_);
    look_once_ = true;
    std::vector<fs::path> watched = files_.files();
    if (job_.look.empty() && o_.job.look.empty())
      watched.push_back(fs::path(job_.scene).replace_extension(".look.json"));
    watch_->set(watched, files_.folders());
  }

  Expected<void> look_again(Clock::time_point begin) {
    begun_ = fs::file_time_type::clock::now();
    FileChanges changes = files_.changes();
    Job before = job_;
    if (job_.look.empty() && o_.job.look.empty())
      if (const fs::path look = look_beside(job_.scene); !look.empty()) {
        job_.look = look.string();
        changes.scene = true, changes.names.push_back(look.filename().string());
      }
    if (!changes.any()) {
      if (!refused_.empty()) log::info("the file is as before again: the picture stays");
      refused_.clear();
      return {};
    }
    const std::string what =
        joined(changes.names.size() > 4 ? std::vector<std::string>(changes.names.begin(), changes.names.begin() + 4)
                                        : changes.names);
    changes.scene |= behind_.scene, changes.look |= behind_.look, changes.shaders |= behind_.shaders;
    behind_ = changes;
    if (auto read = reread(changes); !read) return refuse(read.error(), std::move(before));
    if (auto drawn = draw(begin, what + " changed"); !drawn) return refuse(drawn.error(), std::move(before));
    behind_ = {};
    refused_.clear();
    take_files();
    return {};
  }

  // The last picture stays until the files are whole. What ends a device, or the outputs, ends the command.
  Expected<void> refuse(const Error& error, Job before) {
    job_ = std::move(before);
    if (error.kind != ErrorKind::input && error.kind != ErrorKind::usage && error.kind != ErrorKind::nonfinite)
      return std::unexpected(error);
    if (error.text() == refused_) return {};
    refused_ = error.text();
    log::error("{}", refused_);
    log::info("the last picture stays; waiting for another change");
    watch_->set(files_.files(), files_.folders());
    return {};
  }

  Expected<void> reread(const FileChanges& changes) {
    bool anew = changes.scene;
    if (!anew && changes.look) {
      const auto in_place = session_->reread_look();
      if (!in_place) return std::unexpected(in_place.error());
      anew = !*in_place;
    }
    if (anew) {
      if (auto opened = open(); !opened) return opened;
      return note_scene(session_->scene(), Strictness::none);
    }
    if (changes.shaders) session_->reread_shaders();
    return {};
  }

  Expected<void> draw(Clock::time_point begin, const std::string& why) {
    auto frame = session_->render(moment_.time_s);
    if (!frame) return std::unexpected(frame.error());
    std::vector<std::string> warnings;
    for (const std::string& note : frame->notes) said_.note(note);
    if (auto noted = note_frame(*frame, session_->scene(), Strictness::none, warnings); !noted) return noted;
    std::set<std::string> losses = losses_of(session_->scene().warnings, frame->warnings);
    if (last_)
      for (const std::string& loss : losses)
        if (!losses_.contains(loss)) return fail(ErrorKind::input, "", "{}", loss);
    if (auto written = write_outputs(*frame, job_, *session_, moment_.frame, moment_.rate, paths_); !written)
      return written;
    const double ms = ms_since(begin);
    DisplayImage picture = display_image(*frame, job_);
    std::set<std::string> passes;
    for (const PlanPass& pass : frame->plan->passes) passes.insert(pass.name);
    std::optional<PictureDistance> distance;
    if (last_) distance = picture_distance(*last_, picture);
    ++pictures_;
    say(ms, why, *frame, last_ ? pass_changes(passes_, passes) : "", distance);
    last_ = std::move(picture);
    passes_ = std::move(passes);
    losses_ = std::move(losses);
    return {};
  }

  void say(double ms, const std::string& why, const FrameResult& frame, const std::string& changed,
           const std::optional<PictureDistance>& distance) {
    const size_t passes = frame.plan->passes.size();
    std::string text = fmt::format("{}: {:.0f} ms, {} passes{}", why, ms, passes, changed);
    if (distance && distance->rmse == 0)
      text += "; the same as the last picture";
    else if (distance)
      text += fmt::format("; from the last picture RMSE {:.3g}, FLIP {:.3g}", distance->rmse, distance->flip);
    text += longest_passes(frame.timings.gpu_ms);
    log::info("{}", text);
    if (!o_.job.json) return;
    Json j = {{"picture", pictures_}, {"why", why}, {"ms", ms}, {"passes", passes}};
    for (const gpu::PassTime& pass : frame.timings.gpu_ms) j["gpu_ms"][pass.name] = pass.gpu_ms;
    if (distance) j["rmse"] = distance->rmse, j["flip"] = distance->flip;
    j["outputs"] = Json::array();
    for (const fs::path& path : paths_) j["outputs"].push_back(path.string());
    if (auto printed = print(j.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"); !printed)
      log::error("{}", printed.error().text());
  }

  const WatchOptions& o_;
  Job job_;
  Moment moment_;
  RunSettings settings_;
  WantedOutputs wanted_;
  std::vector<fs::path> paths_;
  std::unique_ptr<Session> session_;
  std::optional<FileWatch> watch_;
  WatchedFiles files_;
  SaidOnce said_;
  fs::file_time_type begun_;  // when the making of the last picture
  bool look_once_ = false;
  int pictures_ = 0;
  std::optional<DisplayImage> last_;
  std::set<std::string> passes_, losses_;  // of the last picture
  FileChanges behind_;   // what the session has read and no picture shows: to be read again with the next change
  std::string refused_;  // why the picture is not that of the files; empty: it is
};

Expected<int> run_watch(CLI::App& command, WatchOptions& o) {
  if (auto read = read_config(command, o.job.config); !read) return std::unexpected(read.error());
  set_log_level(o.job);
  if (o.outputs.empty()) return fail(ErrorKind::usage, "-o", "no output given; name a file that ends in .exr or .png");
  auto settings = run_settings_of(o.job);
  if (!settings) return std::unexpected(settings.error());
  settings->command = command_line();
  settings->timed = o.pass_times;
  settings->timeout_folder = folder_of_outputs(o.outputs);
  auto job = job_of(o.job);
  if (!job) return std::unexpected(job.error());
  const auto moment = moment_of(o.job, o.moment);
  if (!moment) return std::unexpected(moment.error());
  HeldSignals held;  // a signal ends the program when the picture in hand is written
  Watch watch(o, std::move(*job), *moment, std::move(*settings));
  if (auto begun = watch.begin(); !begun) return std::unexpected(begun.error());
  return watch.run(held.pending());
}

}  // namespace

void add_watch(CLI::App& app, Action& action) {
  auto o = std::make_shared<WatchOptions>();
  CLI::App* command = app.add_subcommand("watch", "Render one frame again whenever its files change");
  add_job_options(*command, o->job);
  add_moment_options(*command, o->moment);
  command
      ->add_option("-o,--output", o->outputs,
                   "File to write, again for each change; the ending chooses EXR or PNG; may be given again")
      ->allow_extra_args(false)
      ->type_name("FILE");
  command->add_option("--stop-after", o->pictures, "Stop after this many pictures; by default only Ctrl-C stops it")
      ->check(CLI::Range(1, 1000000000))
      ->type_name("N");
  command->add_flag("--pass-times", o->pass_times, "Print the slowest passes too; passes then run one after the other");
  add_run_options(*command, o->job);
  command->callback([command, o, &action] { action = [command, o] { return run_watch(*command, *o); }; });
}

}  // namespace candela::cli
