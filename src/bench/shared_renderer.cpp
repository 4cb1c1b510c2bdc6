#include "bench/shared_renderer.h"

#include "base/files.h"
#include "base/json.h"
#include "glsl/built_in_spirv.h"
#include "gpu/device_select.h"
#include "job/job_look.h"
#include "job/picture_window.h"
#include "plan/posed_scene.h"
#include "session/device_samples.h"
#include "session/draw_probes.h"

namespace candela {
namespace {
// What a scene of the assets may have; room for more costs time with every frame.
constexpr uint32_t textures = 256;

Error as_error(const gpu::GpuError& e) {
  return {e.out_of_memory() ? ErrorKind::out_of_memory : ErrorKind::device, e.what(), ""};
}
}  // namespace

Expected<std::unique_ptr<SharedRenderer>> SharedRenderer::open(const RunSettings& settings) {
  std::unique_ptr<SharedRenderer> renderer(new SharedRenderer);
  renderer->settings_ = settings;
  auto device = gpu::Device::open({settings.device, settings.validate});
  if (!device) return std::unexpected(device.error());
  renderer->device_ = std::move(*device);
  try {
    renderer->bindless_ = std::make_unique<gpu::Bindless>(*renderer->device_, textures);
    const std::filesystem::path cache = cache_folder();
    renderer->runner_ = std::make_unique<gpu::FrameRunner>(
        *renderer->device_, *renderer->bindless_,
        glsl::ShaderCompiler(settings.shader_folder, cache, glsl::built_in_spirv()), cache);
    renderer->runner_->timeout_s = settings.timeout_s;
  } catch (const gpu::GpuError& e) {
    return std::unexpected(as_error(e));
  }
  return renderer;
}

SharedRenderer::~SharedRenderer() = default;

Expected<void> SharedRenderer::load(const std::string& scene_file, const std::string& sky_file) {
  sky_ = {};
  Job job;
  job.scene = scene_file;
  motion_.clear();
  if (auto opened = open_scene(job); !opened) return opened;
  look_file_.clear();
  return read_sky(sky_file, {});
}

Expected<void> SharedRenderer::open_scene(const Job& job) {
  gpu_scene_.reset();
  auto scene = load_scene(job);
  if (!scene) return std::unexpected(scene.error());
  scene_ = std::move(*scene);
  warnings_ = scene_.warnings;
  auto layout = layout_geometry(scene_);
  if (!layout) return std::unexpected(layout.error());
  layout_ = std::move(*layout);
  if (2 * scene_.images.size() + 1 + 2 * gpu_sky_textures + GpuProbes::textures > textures)
    return fail(ErrorKind::input, job.scene, "has {} images, more than the {} that fit here", scene_.images.size(),
                textures / 2);
  try {
    if (gpu::has_float64(device_->physical())) {
      lights_ = layout_lights(scene_), instances_ = layout_instances(scene_);
      on_device_ = {&lights_, &instances_};
    }
    gpu_scene_ = std::make_unique<GpuScene>(*device_, *bindless_, scene_, layout_, on_device_);
  } catch (const gpu::GpuError& e) {
    return std::unexpected(as_error(e));
  }
  return {};
}

Expected<void> SharedRenderer::follow_motion(const Job& job) {
  const auto look = job.look.empty() ? Expected<Look>{Look{}} : read_look_motion(job.look);
  if (!look) return std::unexpected(look.error());
  std::string motion;
  for (const auto* paths : {&job.paths, &look->paths})
    for (const PathRequest& path : *paths) motion += path_json(path).dump() + "\n";
  for (const auto* instances : {&job.instances, &look->instances})
    for (const InstancesRequest& i : *instances) motion += instances_json(i).dump() + "\n";
  if (!look->paths.empty() || !look->instances.empty()) motion += job.look;  // whose folder names are of
  if (motion == motion_) return {};
  Job moved;
  moved.scene = scene_.path, moved.camera = job.camera;
  moved.look = job.look, moved.paths = job.paths, moved.instances = job.instances;
  motion_ = "?";  // after an error none is there
  if (auto opened = open_scene(moved); !opened) return opened;
  motion_ = std::move(motion);
  return {};
}

Expected<void> SharedRenderer::read_sky(const std::string& sky_file, const std::string& look_file) {
  Job job;
  job.scene = scene_.path, job.sky = sky_file, job.look = look_file;
  const auto look = look_of(job);
  if (!look) return std::unexpected(look.error());
  auto sky = JobSky::read(job, *look, scene_, warnings_);
  if (!sky) return std::unexpected(sky.error());
  sky_ = std::move(*sky), sky_file_ = sky_file, look_file_ = look_file;
  return {};
}

Expected<FrameResult> SharedRenderer::one_frame(const Job& job, const PlanContext& context, const WantedOutputs& wanted,
                                                double time_s, SubframeSums& sums) {
  auto planned = plan_frame(job, context, wanted, time_s);
  if (!planned) return std::unexpected(planned.error());
  std::vector<std::string> of_probes;
  if (planned->facts.probes > 0)  // of each job its own
    if (auto drawn = draw_probes(job, context, *planned, *runner_, *gpu_scene_, of_probes); !drawn)
      return std::unexpected(drawn.error());
  GpuScene::Uploaded uploaded;
  gpu_scene_->upload(*planned, uploaded);
  if (const auto prepared = runner_->prepare(planned->graph()); !prepared) return std::unexpected(prepared.error());
  sums.import(planned->graph().plan, uploaded.imports, uploaded.keep);
  FrameResult frame;
  frame.window = picture_window(job);
  frame.width_px = frame.window.part.width, frame.height_px = frame.window.part.height;
  frame.time_s = time_s;
  frame.outputs = planned->made->outputs;
  frame.readbacks = runner_->run(planned->graph(), uploaded.imports, {}).readbacks;
  frame.pre_exposure = planned->upload.constants.pre_exposure;
  frame.notes.assign(planned->notes.begin(), planned->notes.end());
  frame.warnings = std::move(of_probes);
  frame.warnings.insert(frame.warnings.end(), uploaded.warnings.begin(), uploaded.warnings.end());
  if (settings_.validate)
    if (const auto messages = device_->validation_messages(); !messages.empty())
      return fail(ErrorKind::device, "", "the validation layer says ({} in all): {}", messages.size(),
                  messages.front());
  return frame;
}

Expected<FrameResult> SharedRenderer::frame(const Job& job, const WantedOutputs& wanted, double time_s) {
  if (auto fine = check_window(job); !fine) return std::unexpected(fine.error());
  if (auto moved = follow_motion(job); !moved) return std::unexpected(moved.error());
  if (job.look != look_file_)  // which may have a sky
    if (auto read = read_sky(sky_file_, job.look); !read) return std::unexpected(read.error());
  try {
    if (auto fine = check_samples(job, device_samples(*device_), device_->info().name); !fine)
      return std::unexpected(fine.error());
    PlanContext context{scene_, layout_, &sky_};
    context.cpu = shades_on_cpu(*device_);
    context.on_device = on_device_;
    SubframeSums sums(*device_);
    const auto frames = subframes_of(job, context, time_s);
    if (!frames) return std::unexpected(frames.error());
    if (frames->empty()) return one_frame(job, context, wanted, time_s, sums);
    Expected<FrameResult> picture{FrameResult{}};
    std::vector<std::string> warnings;
    for (const Subframe& subframe : *frames) {
      context.subframe = &subframe;
      picture = one_frame(job, context, wanted, subframe.time_s, sums);
      if (!picture) return picture;
      for (const std::string& warning : picture->warnings)
        if (std::ranges::find(warnings, warning) == warnings.end()) warnings.push_back(warning);
    }
    picture->warnings = std::move(warnings);
    return picture;
  } catch (const gpu::GpuError& e) {
    return std::unexpected(as_error(e));
  }
}

Expected<Beauty> SharedRenderer::render(const Job& job, double time_s) {
  const auto made = frame(job, {.linear = true, .display = false}, time_s);
  if (!made) return std::unexpected(made.error());
  auto beauty = beauty_of(*made);
  if (!beauty) return fail(ErrorKind::device, "", "the frame has no linear picture");
  return std::move(*beauty);
}

}  // namespace candela
