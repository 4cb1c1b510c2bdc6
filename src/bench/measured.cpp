#include "bench/measured.h"

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/clock.h"
#include "base/hash.h"
#include "job/frame_choices.h"
#include "plan/frame_rays.h"
#include "render/outputs.h"
#include "scene/frame_data.h"
#include "session/timings.h"

namespace candela {
namespace {

std::string line_value(const char* file, std::string_view key) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with(key)) {
      const size_t colon = line.find(':');
      const size_t begin = colon == std::string::npos ? colon : line.find_first_not_of(" \t", colon + 1);
      return begin == std::string::npos ? std::string() : line.substr(begin);
    }
  return {};
}

// Bytes of main memory that new allocations can have, and in all.
std::pair<uint64_t, uint64_t> main_memory() {
  const auto bytes = [](std::string_view key) {
    return std::strtoull(line_value("/proc/meminfo", key).c_str(), nullptr, 10) * 1024;
  };
  return {bytes("MemAvailable"), bytes("MemTotal")};
}

int64_t lights_in_frame(const Scene& scene, const Job& job, const View& view, double time_s) {
  const auto animations = choose_animations(scene, job.animation);
  if (!animations) return -1;
  return int64_t(make_frame_data(scene, evaluate_pose(scene, *animations, time_s), view).lights.size());
}

// All knobs as the job sets them, so that equal hashes mean equal knobs even when defaults change between versions.
std::string knob_hash(const Job& job, int samples) {
  std::map<std::string, std::string> values;
  for (const KnobRow& knob : knob_rows(job.quality)) values[knob.pass + "." + knob.knob] = knob.value_now;
  for (const KnobSetting& s : job.settings) values[s.pass + "." + s.knob] = s.value;
  std::string text = fmt::format("samples={}\n", samples);
  for (const auto& [name, value] : values) text += name + "=" + value + "\n";
  return hash128(text).hex();
}

}  // namespace

std::string processor_name() { return line_value("/proc/cpuinfo", "model name"); }

Measured::Measured(const Configuration& configuration, const Suite& suite, const RunSettings& settings)
    : configuration_(configuration),
      views_(configuration.views),
      rules_(suite.sampling),
      settings_(settings),
      runs_(suite.sampling.min_runs) {
  if (views_.empty()) views_.push_back({configuration.job.camera, configuration.time_s});
  const Job& job = configuration.job;
  settings_.timed = true;
  wanted_ = {.linear = suite.output != "png", .display = suite.output != "exr"};
  row.suite = suite.name;
  row.scene = configuration.scene.label;
  row.technique = job.technique;
  row.settings = settings_text(job);
  row.quality = job.quality;
  row.effects = job.effects;
  row.transparency = job.transparency;
  row.sky = configuration.scene.sky.label, row.look = configuration.scene.look.label;
  row.output = suite.output;
  row.seed = configuration.scene.generated() ? configuration.seed : 0;
  row.lights_wanted = configuration.lights.value_or(-1);
  row.camera = job.camera.camera;
  row.width_px = job.width_px, row.height_px = job.height_px, row.samples = job.samples;
  row.time_s = configuration.time_s;
  row.views = int(views_.size());
  row.version = CANDELA_VERSION;
  row.machine = processor_name();
  row.cores = int(std::thread::hardware_concurrency());
  Job named = job;  // files by their labels: where they lie does not matter
  named.sky = row.sky, named.look = row.look;
  row.job = job_json(named);
  row.gpu.name = "gpu", row.frame.name = "frame";
}

Expected<FrameResult> Measured::render(size_t view) {
  used_->set_camera(views_[view].camera);
  const auto start = Clock::now();
  auto frame = used_->render(views_[view].time_s);
  last_frame_ms_ = ms_since(start);
  return frame;
}

Expected<double> Measured::render_views() {
  double ms = 0;
  for (size_t view = 0; view < views_.size(); ++view) {
    const auto frame = render(view);
    if (!frame) return std::unexpected(frame.error());
    ms += last_frame_ms_;
  }
  return ms / double(views_.size());
}

void Measured::describe(const FrameResult& frame) {
  const gpu::DeviceInfo& device = used_->device().info();
  row.device = device.name, row.driver = device.driver, row.device_class = device.device_class;
  row.device_type = device.type;
  row.scene_content = used_->scene_content().hex();
  row.samples = frame.request.samples;
  row.plan_hash = frame.plan_hash.hex();
  row.knob_hash = knob_hash(configuration_.job, row.samples);
  row.lights = lights_in_frame(used_->scene(), configuration_.job, frame.view, configuration_.time_s);
  row.opening_ms.clear();
  for (const auto& [stage, ms] : used_->opening().cpu_ms) row.opening_ms.emplace_back(stage, ms);
  for (const char* stage : {"decode", "compile", "warm_up"})
    row.opening_ms.emplace_back(std::string("first ") + stage, frame.timings.total(stage));
  row.remarks = frame.notes;
  row.remarks.insert(row.remarks.end(), frame.warnings.begin(), frame.warnings.end());
  row.trees.clear();
  if (frame.rays) {
    const AccelStatistics& t = frame.rays->statistics;
    row.trees = {{"triangles", t.triangles}, {"references", t.references}, {"binary_nodes", t.binary_nodes},
                 {"nodes", t.nodes},         {"bytes", t.bytes},           {"instances", t.instances}};
  }
  row.memory.clear();
  const nlohmann::ordered_json memory = memory_json(*used_, *frame.plan);
  for (const auto& [name, bytes] : memory.items())
    if (name != "process_peak_bytes") row.memory.emplace_back(name, bytes.get<uint64_t>());
}

Expected<void> Measured::open_session(const std::string& scene_file) {
  Job job = configuration_.job;
  job.scene = scene_file;
  auto session = Session::open(job, wanted_, settings_);
  if (!session) return std::unexpected(session.error());
  session_ = std::move(*session);
  used_ = session_.get();
  return {};
}

Expected<void> Measured::warm_up() {
  std::vector<double> frames;
  while (!warmed_up(frames, rules_)) {
    const auto ms = render_views();
    if (!ms) return std::unexpected(ms.error());
    frames.push_back(*ms);
  }
  row.warm_up_frames = int(frames.size());
  return {};
}

Expected<void> Measured::open(const std::string& scene_file,
                              const std::function<void(const FrameResult&, const Session&)>& seen) {
  if (auto opened = open_session(scene_file); !opened) return opened;
  // The first frame compiles; the picture is checked on it.
  for (size_t view = 0; view < views_.size(); ++view) {
    const auto frame = render(view);
    if (!frame) return std::unexpected(frame.error());
    if (view == 0) {
      first_frame_ms_ = last_frame_ms_;
      describe(*frame);
      beauty_ = beauty_of(*frame);
    }
    if (seen) seen(*frame, *session_);
  }
  return warm_up();
}

void Measured::close() {
  session_.reset();
  row.reopened = true;
}

uint64_t Measured::device_bytes() const { return session_ ? session_->device().memory_use().peak : 0; }

bool Measured::fits_beside(int others, uint64_t others_bytes) const {
  if (!session_) return true;
  const gpu::DeviceInfo& device = session_->device().info();
  // Each session has a VkDevice of its own. NVIDIA's driver 580 ends the process at about the fiftieth.
  constexpr int most_devices = 32;
  if (!device.is_cpu && others >= most_devices) return false;
  // A quarter stays free for what is opened next and for what else runs.
  const auto [available, total] = main_memory();
  if (available < total / 4) return false;
  return device.is_cpu || others_bytes + device_bytes() < device.memory_bytes / 4 * 3;
}

bool Measured::lacks_runs() const { return int(row.frame.ms.size()) < rules_.min_runs; }

bool Measured::wants_sample() const { return int(row.frame.ms.size()) < runs_; }

void Measured::decide_runs() {
  if (decided_ || int(row.frame.ms.size()) < rules_.min_runs) return;
  const RunCount count = runs_needed(row.frame.ms, rules_);
  runs_ = count.runs;
  row.runs_capped = count.capped;
  decided_ = true;
}

Expected<void> Measured::sample(const std::string& scene_file) {
  const bool closed = !session_;
  if (closed) {
    if (auto opened = open_session(scene_file); !opened) return opened;
    if (auto warm = warm_up(); !warm) return warm;
  }
  if (const auto taken = take_sample({}); !taken) return std::unexpected(taken.error());
  if (closed) session_.reset();
  decide_runs();
  return {};
}

Expected<bool> Measured::take_sample(const std::function<bool()>& over) {
  // Means over the views. A pass that stands several times in a frame counts once, with all its times.
  const double part = 1 / double(views_.size());
  double gpu = 0;
  std::vector<std::pair<std::string, double>> passes, stages;
  const auto add = [&](auto& into, const std::string& name, double ms) {
    auto found = std::find_if(into.begin(), into.end(), [&](const auto& entry) { return entry.first == name; });
    if (found == into.end()) found = into.insert(into.end(), {name, 0});
    found->second += ms * part;
  };
  double frame_ms = 0;
  for (size_t view = 0; view < views_.size(); ++view) {
    if (over && over()) return false;
    const auto frame = render(view);
    if (!frame) return std::unexpected(frame.error());
    frame_ms += last_frame_ms_ * part;
    gpu += frame->timings.frame_gpu_ms * part;
    for (const gpu::PassTime& pass : frame->timings.gpu_ms)
      add(passes, pass.name.substr(0, pass.name.find('.')), pass.gpu_ms);
    for (const auto& [stage, stage_ms] : frame->timings.cpu_ms) add(stages, stage, stage_ms);
  }
  row.frame.ms.push_back(frame_ms);
  row.gpu.ms.push_back(gpu);
  for (const auto& [name, pass_ms] : passes) series(row.passes, name).ms.push_back(pass_ms);
  for (const auto& [stage, stage_ms] : stages) series(row.cpu, stage).ms.push_back(stage_ms);
  return true;
}

Expected<bool> Measured::open_in(Session& session, const std::function<bool()>& over,
                                 const std::function<void(size_t view, const FrameResult&, const Session&)>& seen) {
  used_ = &session;
  if (auto set = session.set_settings(configuration_.job); !set) return std::unexpected(set.error());
  for (size_t view = 0; view < views_.size(); ++view) {
    if (over()) return false;
    const auto frame = render(view);
    if (!frame) return std::unexpected(frame.error());
    if (view == 0) {
      first_frame_ms_ = last_frame_ms_;
      describe(*frame);
    }
    seen(view, *frame, session);
  }
  return true;
}

Expected<bool> Measured::sample_in(Session& session, int round, bool visited, const std::function<bool()>& over) {
  used_ = &session;
  if (auto set = session.set_settings(configuration_.job); !set) return std::unexpected(set.error());
  if (visited) {
    if (over()) return false;
    if (const auto warm = render(0); !warm) return std::unexpected(warm.error());
  }
  if (const auto taken = take_sample(over); !taken || !*taken) return taken;
  row.rounds.push_back(round);
  decide_runs();
  return true;
}

void Measured::fail_with(const Error& error) {
  row.error = error.text();
  row.error_kind = int(error.kind);
  session_.reset();
}

void Measured::finish() {
  session_.reset();
  beauty_.reset();
}

namespace {

bool is_of_place(const BenchRow& row, const BenchRow& wanted, const Session& session) {
  return row.scene == wanted.scene && row.time_s == wanted.time_s && row.device == session.device().info().name &&
         !row.gpu.ms.empty();
}

}  // namespace

Expected<const BenchRow*> kept_row(const std::vector<BenchRow>& all, const BenchRow& wanted, const Session& session,
                                   bool any_setting) {
  for (const BenchRow& row : all) {
    if (!is_of_place(row, wanted, session)) continue;
    if (row.scene_content != session.scene_content().hex())
      return fail(ErrorKind::input, row.scene,
                  "has changed since the rows that --resume goes on from were measured; name another --json file");
    if (any_setting || (row.suite == wanted.suite && row.job == wanted.job && row.views == wanted.views)) return &row;
  }
  return nullptr;
}

Expected<SeenFrame> render_once(const Configuration& configuration, SceneStore& store, const RunSettings& settings,
                                const WantedOutputs& wanted, int most_px) {
  const auto file = store.file_of(configuration);
  if (!file) return std::unexpected(file.error());
  Job job = configuration.job;
  job.scene = *file;
  const auto session = Session::open(job, wanted, settings);
  if (!session) return std::unexpected(session.error());
  const auto frame = (*session)->render(configuration.time_s);
  if (!frame) return std::unexpected(frame.error());
  SeenFrame seen;
  seen.beauty = beauty_of(*frame);
  seen.lists = light_lists(*frame);
  if (most_px > 0) {
    seen.heatmap = heatmap_png(layer_values(*frame, listed_layer), frame->width_px, frame->height_px, most_px);
    if (wanted.display) seen.thumbnail = thumbnail_png(display_image(*frame, job), most_px);
  }
  return seen;
}

}  // namespace candela
