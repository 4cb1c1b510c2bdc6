#include "session/session.h"

#include <future>

#include "base/allocations.h"
#include "base/check.h"
#include "base/file_uses.h"
#include "base/files.h"
#include "base/log.h"
#include "glsl/built_in_spirv.h"
#include "gpu/device_select.h"
#include "gpu/kept_image.h"
#include "job/choose_occlusion.h"
#include "job/choose_transparency.h"
#include "job/job_look.h"
#include "plan/choose_sides.h"
#include "plan/posed_scene.h"
#include "plan/scene_motion.h"
#include "scene/moving_nodes.h"
#include "session/begun_frame.h"
#include "session/device_samples.h"
#include "session/draw_probes.h"
#include "session/gpu_scene.h"
#include "session/gpu_sky.h"
#include "session/kept_images.h"
#include "session/look_read.h"
#include "session/one_picture.h"
#include "session/subframe_sums.h"
#include "session/timeout_report.h"
#include "session/timings.h"

namespace candela {
namespace {

class DeviceSession : public Session {
 public:
  DeviceSession(Job job, WantedOutputs wanted, RunSettings settings)
      : asked_(std::move(job)), job_(asked_), wanted_(wanted), settings_(std::move(settings)) {}

  Expected<void> open();
  Expected<FrameTicket> begin(double time_s, bool hash_outputs) override {
    return begin_job(job_, time_s, hash_outputs);
  }
  Expected<FrameResult> finish(FrameTicket ticket) override;
  // The host plans, uploads and records the next frame while the device renders; a CPU device has no cores to spare.
  int in_flight() const override { return settings_.timed || device_->info().is_cpu ? 1 : 2; }
  void set_camera(const CameraRequest& camera) override { asked_.camera = job_.camera = camera; }
  Expected<void> set_settings(const Job& job) override;
  Expected<bool> reread_look() override;
  void reread_shaders() override;
  void take_trees(const Session& earlier) override { rays_ = earlier.trees(); }
  std::shared_ptr<const FrameRays> trees() const override { return rays_; }
  Expected<FrameWork> work(double time_s) const override;
  const Scene& scene() const override { return scene_; }
  const gpu::Device& device() const override { return *device_; }
  const Timings& opening() const override { return opening_; }
  Hash128 scene_content() const override { return scene_content_; }

 private:
  Expected<void> load();
  Expected<void> find_moving();
  void take_look(LookRead look);
  void make_runner();
  Expected<void> choose_by_device();
  Expected<void> choose_again();
  PlanContext plan_context() const;
  Expected<FrameTicket> begin_job(const Job& job, double time_s, bool hash_outputs);
  // One frame: the picture, or a part of it. look: at that time, if it is known.
  Expected<FrameTicket> begin_frame(const Job& job, double time_s, bool hash_outputs, const Subframe* subframe,
                                    const Look* look);
  // Hands a planned frame to the device.
  Expected<FrameTicket> submit(PlannedFrame& planned, SubmitTimes& times, bool hash_outputs);
  // The error with where the frame left what shows why it did not end in time: session/timeout_report.h.
  Error failed(const gpu::GpuError& error, const FramePlan& plan) const;
  // Waits for a frame that was begun and takes what it left; once.
  void collect(FrameTicket ticket);
  Job asked_, job_;  // as it was given; with what was left to us chosen
  std::string told_technique_, told_transparency_, told_sides_;
  std::optional<ChosenSides> early_sides_;  // while the device opened
  bool chose_transparency_ = false;         // the job left it to us: no frame is refused for its method's knobs
  WantedOutputs wanted_;
  RunSettings settings_;
  Timings opening_;
  Scene scene_;
  GeometryLayout layout_;
  LightLayout lights_;  // where the device can pose them
  InstanceLayout instances_;
  DevicePose on_device_;
  std::optional<JobSky> sky_;
  std::string left_out_;                            // of the look
  std::string motion_, skies_;                      // as read_look_files() tells them
  bool has_probes_ = false, probes_drawn_ = false;  // drawn: with the settings of the job at hand
  bool stores_samples_ = true;                      // of the job, on the device
  Hash128 scene_content_;
  std::optional<LookFile> look_;
  std::shared_ptr<const FrameRays> rays_;  // of the last frame that had some
  std::unique_ptr<gpu::Device> device_;
  std::unique_ptr<gpu::Bindless> bindless_;
  std::unique_ptr<GpuScene> gpu_scene_;
  std::unique_ptr<gpu::ImageCache> kept_;  // null: nothing is kept
  LampPool lamp_pool_;                     // what `lamp_image_` holds once frames in flight are drawn
  std::shared_ptr<gpu::KeptImage> lamp_image_;
  std::unique_ptr<gpu::FrameRunner> runner_;
  std::map<FrameTicket, BegunFrame> begun_;
  std::unique_ptr<SubframeSums> sums_;
  // Of the frame at hand; their memory serves the next one.
  KeptGraphs graphs_;
  KeptKeys kept_keys_;
  PlannedFrame planned_;
  GpuScene::Uploaded uploaded_;
  KeptImages kept_images_;
  gpu::RunOptions run_options_;
  // As PlanContext has them.
  std::vector<uint8_t> moving_;
  PosedParts parts_;
  ChosenOcclusion occlusion_;
  double device_clock_us_ = -HUGE_VAL;  // as take_run() has it
};

Expected<void> DeviceSession::load() {
  const StageTimer timer(opening_, "load");
  auto scene = load_scene(job_);
  if (!scene) return std::unexpected(scene.error());
  scene_ = std::move(*scene);
  auto layout = layout_geometry(scene_);
  if (!layout) return std::unexpected(layout.error());
  layout_ = std::move(*layout);
  if (auto found = find_moving(); !found) return found;
  auto look = read_look_files(job_);
  if (!look) return std::unexpected(look.error());
  auto sky = read_sky(job_, *look, scene_);
  if (!sky) return std::unexpected(sky.error());
  sky_ = std::move(*sky);
  if (auto hashed = hash_look(job_, scene_, *look); !hashed) return hashed;
  take_look(std::move(*look));
  return check_outputs();
}

// What the job's animations and paths move.
Expected<void> DeviceSession::find_moving() {
  const auto animations = choose_animations(scene_, job_.animation);
  if (!animations) return std::unexpected(animations.error());
  const std::vector<bool> moving = moving_nodes(scene_, *animations);
  moving_.assign(moving.begin(), moving.end());
  parts_ = posed_parts(scene_, *animations);
  occlusion_ = choose_occlusion(scene_, job_.animation);
  return {};
}

void DeviceSession::take_look(LookRead look) {
  look_ = std::move(look.file);
  motion_ = std::move(look.motion), skies_ = std::move(look.skies);
  left_out_ = left_out_of(job_, look.at_begin);
  has_probes_ = !look.at_begin.probes.empty();
  scene_content_ = look.content;
}

Expected<bool> DeviceSession::reread_look() {
  CHECK_MSG(begun_.empty(), "reread_look while frames are in flight");
  auto look = read_look_files(job_);
  if (!look) return std::unexpected(look.error());
  if (auto hashed = hash_look(job_, scene_, *look); !hashed) return std::unexpected(hashed.error());
  const bool has_room = has_probes_ || look->at_begin.probes.empty();
  if (look->motion != motion_ || !has_room) return false;
  std::optional<JobSky> sky;
  if (look->skies != skies_) {
    auto read = read_sky(job_, *look, scene_);
    if (!read) return std::unexpected(read.error());
    sky = std::move(*read);
  }
  if (auto moved = add_paths_again(scene_, job_); !moved) return std::unexpected(moved.error());
  scene_.view_hulls = std::make_shared<KeptViewHulls>();
  if (auto found = find_moving(); !found) return std::unexpected(found.error());
  if (sky) sky_ = std::move(*sky);
  take_look(std::move(*look));
  job_ = asked_;
  if (auto chosen = choose_again(); !chosen) return std::unexpected(chosen.error());
  return true;
}

void DeviceSession::make_runner() {
  const std::filesystem::path cache = cache_folder();
  runner_ = std::make_unique<gpu::FrameRunner>(
      *device_, *bindless_, glsl::ShaderCompiler(settings_.shader_folder, cache, glsl::built_in_spirv()), cache);
  runner_->timeout_s = settings_.timeout_s;
}

void DeviceSession::reread_shaders() {
  CHECK_MSG(begun_.empty(), "reread_shaders while frames are in flight");
  make_runner();
  probes_drawn_ = false;
}

// What the job leaves to us or asks of the device. GpuError where it does not say what it has.
Expected<void> DeviceSession::choose_by_device() {
  if (job_.technique == auto_technique) {
    const ChosenTechnique chosen = quickest_technique(device_->info().is_cpu, device_->info().int64_atomics);
    job_.technique = chosen.name;
    if (std::exchange(told_technique_, chosen.name) != chosen.name)
      log::info("technique auto: {}, because {}", chosen.name, chosen.why);
  }
  if (job_.transparency == auto_transparency) {
    const auto limits = transparency_device(job_, *device_);
    if (!limits) return std::unexpected(limits.error());
    const ChosenTransparency chosen = choose_transparency(scene_, job_, limits->samples, limits->device);
    job_.transparency = chosen.name;
    chose_transparency_ = true;
    if (!chosen.why.empty() && std::exchange(told_transparency_, chosen.name) != chosen.name)
      log::info("transparency auto: {}, because {} (--transparency)", chosen.name, chosen.why);
  }
  if (job_.sides == "auto") {
    const ChosenSides chosen = early_sides_ ? *std::exchange(early_sides_, {}) : choose_sides(scene_, job_);
    job_.sides = chosen.name;
    if (!chosen.why.empty() && std::exchange(told_sides_, chosen.name) != chosen.name)
      log::info("light passes single-sided faces from behind, because {} (--sides block stops it)", chosen.why);
  }
  if (auto fine = check_samples(job_, device_samples(*device_), device_->info().name); !fine) return fine;
  const auto stores = stores_samples(job_, *device_);
  if (!stores) return std::unexpected(stores.error());
  stores_samples_ = *stores;
  return {};
}

Expected<void> DeviceSession::open() {
  // The device opens while the scene loads; an error of the scene is the more useful one to name.
  auto opening_device = std::async(std::launch::async, [&] {
    const double start = process_clock_us();
    auto device = gpu::Device::open({settings_.device, settings_.validate, settings_.queues});
    return std::pair(std::move(device), std::pair(start, process_clock_us() - start));
  });
  const auto loaded = load();
  if (loaded && job_.sides == "auto") early_sides_ = choose_sides(scene_, job_);
  auto [device, span] = opening_device.get();
  opening_.spans.push_back({"open device", "device", span.first, span.second});
  if (!loaded) return loaded;
  if (!device) return std::unexpected(device.error());
  device_ = std::move(*device);
  try {
    if (auto chosen = choose_by_device(); !chosen) return chosen;
    const StageTimer timer(opening_, "upload");
    // An image may be uploaded twice, as sRGB and as linear; the split sum is one more.
    const size_t textures =
        std::min<size_t>(2 * scene_.images.size() + 1 + 9 * gpu_sky_textures + (has_probes_ ? GpuProbes::textures : 0),
                         gpu::Bindless::most_textures);
    bindless_ = std::make_unique<gpu::Bindless>(*device_, uint32_t(textures));
    if (gpu::has_float64(device_->physical())) {
      lights_ = layout_lights(scene_), instances_ = layout_instances(scene_);
      on_device_ = {&lights_, &instances_};
    }
    gpu_scene_ = std::make_unique<GpuScene>(*device_, *bindless_, scene_, layout_, on_device_);
    make_runner();
    sums_ = std::make_unique<SubframeSums>(*device_);
    if (settings_.kept_bytes > 0) kept_ = std::make_unique<gpu::ImageCache>(*device_, settings_.kept_bytes);
    opening_.uploaded_bytes = device_->uploaded_bytes();
  } catch (const gpu::GpuError& e) {
    return std::unexpected(as_error(e, device_.get()));
  }
  return {};
}

Expected<void> DeviceSession::set_settings(const Job& job) {
  Job next = asked_;
  next.technique = job.technique, next.quality = job.quality;
  next.samples = job.samples, next.settings = job.settings;
  next.width_px = job.width_px, next.height_px = job.height_px;
  if (job_json(next) == job_json(asked_)) return {};
  if (auto fine = check_job(next); !fine) return fine;
  asked_ = job_ = std::move(next);
  return choose_again();
}

Expected<void> DeviceSession::choose_again() {
  probes_drawn_ = false;
  try {
    return choose_by_device();
  } catch (const gpu::GpuError& e) {
    return std::unexpected(as_error(e, device_.get()));
  }
}

PlanContext DeviceSession::plan_context() const {
  PlanContext context{scene_, layout_, &*sky_, look_ ? &*look_ : nullptr};
  context.on_device = on_device_;
  context.moving = moving_;
  context.parts = &parts_, context.occlusion = &occlusion_;
  context.rays = rays_;
  context.cpu = shades_on_cpu(*device_);
  context.stores_samples = stores_samples_;
  return context;
}

Expected<FrameWork> DeviceSession::work(double time_s) const {
  auto planned = plan_frame(job_, plan_context(), wanted_, time_s);
  if (!planned) return std::unexpected(planned.error());
  return work_of(*planned);
}

Expected<FrameTicket> DeviceSession::begin_job(const Job& job, double time_s, bool hash_outputs) {
  PlanContext context = plan_context();
  const auto look = look_ ? look_->at(time_s) : Expected<Look>(Look{});
  if (!look) return std::unexpected(look.error());
  if (look_) context.look_now = &*look;
  const auto frames = subframes_of(job, context, time_s);
  if (!frames) return std::unexpected(frames.error());
  if (frames->empty()) return begin_frame(job, time_s, hash_outputs, nullptr, context.look_now);
  sums_->begin_picture();
  std::vector<FrameTicket> begun;
  for (const Subframe& frame : *frames) {
    const auto ticket = begin_frame(job, frame.time_s, hash_outputs, &frame, nullptr);
    if (!ticket) {
      for (const FrameTicket t : begun) (void)finish(t);
      return ticket;
    }
    begun.push_back(*ticket);
    // What a frame holds until it is collected would add up.
    if (const size_t ahead = size_t(in_flight()); begun.size() > ahead) collect(begun[begun.size() - 1 - ahead]);
  }
  sums_->begin_picture();
  BegunFrame& picture = begun_.at(begun.back());
  picture.subframes.assign(begun.begin(), begun.end() - 1);
  return begun.back();
}

Expected<FrameTicket> DeviceSession::begin_frame(const Job& job, double time_s, bool hash_outputs,
                                                 const Subframe* subframe, const Look* look) {
  const double start = process_clock_us();
  PlanContext context = plan_context();
  context.subframe = subframe, context.is_whole = !subframe, context.look_now = look;
  context.graphs = &graphs_;
  if (kept_) kept_->keys(kept_keys_), context.kept = &kept_keys_;
  const KeptLamps kept_lamps{lamp_pool_, settings_.kept_bytes};
  if (kept_ && !hash_outputs) context.kept_lamps = &kept_lamps;  // the pool's bytes depend on other frames
  PlannedFrame& planned = planned_;
  if (auto fine = plan_frame(job, context, wanted_, time_s, planned); !fine) return std::unexpected(fine.error());
  if (planned.rays) rays_ = planned.rays;
  if (auto fine = check_traversal(planned.traced.tree, device_->info().rays, device_->info().name); !fine)
    return std::unexpected(fine.error());
  try {
    const uint64_t uploaded_before = device_->uploaded_bytes();
    Timings probe_times;
    std::vector<std::string> probe_warnings;
    if (planned.facts.probes > 0 && !probes_drawn_) {
      const StageTimer timer(probe_times, "probes");
      PlanContext without_rays{scene_, layout_, &*sky_, look_ ? &*look_ : nullptr};
      without_rays.cpu = context.cpu, without_rays.stores_samples = context.stores_samples;
      if (auto drawn = draw_probes(job, without_rays, planned, *runner_, *gpu_scene_, probe_warnings); !drawn)
        return std::unexpected(drawn.error());
      probes_drawn_ = true;
    }
    SubmitTimes times;
    const auto ticket = submit(planned, times, hash_outputs);
    if (!ticket) return ticket;
    // Only now is anything asked of the heap: in a film that goes on with its plan, nothing was until here.
    BegunFrame& begun = begun_[*ticket];
    FrameResult& result = begun.result;
    result.timings = std::move(probe_times), result.warnings = std::move(probe_warnings);
    result.timings.heap_allocations = times.allocations - planned.posed_at_allocations;
    result.time_s = time_s;
    add_stages(planned.clock, start, result.timings);
    add_times(times, result.timings);
    count_lamp_maps(planned.lamps, result.timings);
    result.timings.uploaded_bytes = device_->uploaded_bytes() - uploaded_before;
    result.warnings.insert(result.warnings.end(), uploaded_.warnings.begin(), uploaded_.warnings.end());
    result.window = picture_window(job_);
    result.width_px = result.window.part.width, result.height_px = result.window.part.height;
    result.view = planned.view, result.request = planned.request;
    result.pre_exposure = planned.upload.constants.pre_exposure;
    result.plan_hash = planned.made->hash, result.rays = planned.rays;
    result.dumps = planned.made->dumps, result.outputs = planned.made->outputs;
    result.sees_items = any_in_view(planned.data.items, planned.view);
    result.plan = {planned.made, &planned.made->graph.plan};
    result.notes.assign(planned.notes.begin(), planned.notes.end());
    if (!left_out_.empty()) result.warnings.push_back(left_out_);
    begun.made = planned.made;
    begun.hash_outputs = hash_outputs, begun.submit_us = times.submit_us;
    return ticket;
  } catch (const gpu::GpuError& e) {
    // Not begun again with less in memory: what was half made when memory ended, an image on the device without its
    // content, would be taken for whole, and the frame would be another.
    return std::unexpected(failed(e, planned.graph().plan));
  }
}

Expected<FrameTicket> DeviceSession::submit(PlannedFrame& planned, SubmitTimes& times, bool hash_outputs) {
  // Pipelines know nothing of texels and memory: they are made while textures are decoded and images allocated.
  const bool fresh = !runner_->is_compiled(planned.graph());
  std::future<Expected<gpu::PrepareTimes>> compiling;
  if (fresh)
    compiling = std::async(std::launch::async, [&] {
      const StageTimer timer(times.compiling, "compile", "compile");
      return runner_->compile(planned.graph());
    });
  times.upload_us = process_clock_us();
  gpu_scene_->upload(planned, uploaded_);
  times.allocate_us = process_clock_us();
  runner_->allocate(planned.graph());
  times.allocated_us = process_clock_us();
  if (fresh)
    if (const auto compiled = compiling.get(); !compiled) return std::unexpected(compiled.error());
  if (const auto prepared = runner_->prepare(planned.graph()); !prepared) return std::unexpected(prepared.error());
  sums_->import(planned.graph().plan, uploaded_.imports, uploaded_.keep);
  // Until the frame is handed over nobody knows what it leaves there.
  if (planned.lamps.pool) lamp_pool_.forget();
  kept_images(planned, kept_.get(), lamp_image_, kept_images_);
  uploaded_.keep.push_back(planned.made);
  uploaded_.keep.insert(uploaded_.keep.end(), kept_images_.held.begin(), kept_images_.held.end());
  run_options_ = {.images = std::move(run_options_.images)};
  std::swap(run_options_.images, kept_images_.by_resource);
  if (settings_.timed && fresh) {
    // Drivers finish compiling at a pipeline's first use: an untimed run first, so that passes are charged their own
    // work.
    const StageTimer timer(times.measuring, "warm_up");
    runner_->run(planned.graph(), uploaded_.imports, run_options_, uploaded_.keep);
  }
  if (settings_.overlap) {
    const StageTimer timer(times.measuring, "overlap");
    times.measuring.overlap =
        measure_overlap(*runner_, *device_, planned.graph(), uploaded_.imports, run_options_.images);
  }
  run_options_.timed = settings_.timed, run_options_.hash_outputs = hash_outputs;
  run_options_.spans = settings_.spans && !settings_.timed;
  times.submit_us = process_clock_us();
  const FrameTicket ticket = runner_->submit(planned.graph(), uploaded_.imports, run_options_, uploaded_.keep);
  times.end_us = process_clock_us();
  times.decode_ms = uploaded_.decode_ms;
  times.allocations = heap_allocations();
  uploaded_.keep.clear();
  for (const auto& [key, image] : kept_images_.filled) kept_->insert(key, image);
  kept_images_.held.clear(), kept_images_.filled.clear();
  if (planned.lamps.pool && lamp_image_) copy_pool(*planned.lamps.pool, lamp_pool_), lamp_pool_.fresh = false;
  return ticket;
}

Error DeviceSession::failed(const gpu::GpuError& error, const FramePlan& plan) const {
  Error result = as_error(error, device_.get());
  if (error.result == VK_TIMEOUT && !settings_.timeout_folder.empty())
    result.message += kept_timeout(settings_, job_, device_->info(), plan, result.message);
  return result;
}

// All are waited for, also behind an error: each ticket is collected once.
void DeviceSession::collect(FrameTicket ticket) {
  BegunFrame& begun = begun_.at(ticket);
  if (std::exchange(begun.collected, true)) return;
  try {
    const double start = process_clock_us();
    gpu::FrameRun run = runner_->collect(ticket);
    begun.result.timings.spans.push_back({"wait", "cpu", start, process_clock_us() - start});
    take_run(std::move(run), device_clock_us_, begun);
  } catch (const gpu::GpuError& e) {
    begun.error = failed(e, *begun.result.plan);
  }
}

Expected<FrameResult> DeviceSession::finish(FrameTicket ticket) {
  CHECK_MSG(begun_.contains(ticket), "finish of a frame that was not begun");
  std::vector<FrameTicket> tickets = begun_.at(ticket).subframes;
  tickets.push_back(ticket);
  std::vector<BegunFrame> frames;
  std::optional<Error> error;
  for (const FrameTicket each : tickets) {
    collect(each);
    frames.push_back(std::move(begun_.extract(each).mapped()));
    if (frames.back().error && !error) error = frames.back().error;
  }
  if (error) return std::unexpected(*error);
  const BegunFrame& picture = frames.back();
  const auto refused = std::ranges::find_if(frames, [](const BegunFrame& f) { return !f.refusal.empty(); });
  if (refused != frames.end() && chose_transparency_ && !refused->enlarged.empty()) {
    Job larger = job_;
    larger.settings.insert(larger.settings.end(), refused->enlarged.begin(), refused->enlarged.end());
    chose_transparency_ = false;  // once: what was counted does not change
    const auto again = begin_job(larger, picture.result.time_s, picture.hash_outputs);
    auto result = again ? finish(*again) : Expected<FrameResult>(std::unexpected(again.error()));
    chose_transparency_ = true;
    return result;
  }
  if (refused != frames.end()) return fail(ErrorKind::out_of_memory, "", "{}", refused->refusal);
  if (settings_.validate)
    if (const auto messages = device_->validation_messages(); !messages.empty())
      return fail(ErrorKind::device, "", "the validation layer says ({} in all): {}", messages.size(),
                  messages.front());
  std::vector<FrameResult> results;
  for (BegunFrame& begun : frames) results.push_back(std::move(begun.result));
  return one_picture(std::move(results));
}

}  // namespace

Expected<std::unique_ptr<Session>> Session::open(const Job& job, const WantedOutputs& wanted,
                                                 const RunSettings& settings) {
  if (auto fine = check_job(job); !fine) return std::unexpected(fine.error());
  auto session = std::make_unique<DeviceSession>(job, wanted, settings);
  if (auto opened = session->open(); !opened) return std::unexpected(opened.error());
  return session;
}

}  // namespace candela
