#pragma once
#include <memory>

#include "bench/picture.h"
#include "gpu/frame_runner.h"
#include "plan/plan_frame.h"
#include "session/device_samples.h"
#include "session/gpu_scene.h"
#include "session/subframe_sums.h"

namespace candela {

// Renders many small scenes on one device with one set of pipelines, which a Session makes anew for each job.
class SharedRenderer {
 public:
  static Expected<std::unique_ptr<SharedRenderer>> open(const RunSettings& settings);
  ~SharedRenderer();

  // Paths and instances are those of the job of each frame; where they change the scene is opened again.
  Expected<void> load(const std::string& scene_file, const std::string& sky_file = {});
  // The linear picture of the loaded scene. GpuError becomes an Error here.
  Expected<Beauty> render(const Job& job, double time_s);
  // The pictures with what belongs to them: outputs, pre-exposure, notes and warnings; no times.
  Expected<FrameResult> frame(const Job& job, const WantedOutputs& wanted, double time_s);
  const std::vector<std::string>& warnings() const { return warnings_; }  // of loading scene and sky
  const gpu::DeviceInfo& device() const { return device_->info(); }
  std::vector<int> samples() const { return device_samples(*device_); }  // a pixel, that the device can do

 private:
  SharedRenderer() = default;
  RunSettings settings_;
  std::unique_ptr<gpu::Device> device_;
  std::unique_ptr<gpu::Bindless> bindless_;
  std::unique_ptr<gpu::FrameRunner> runner_;
  Scene scene_;
  GeometryLayout layout_;
  LightLayout lights_;  // where the device can pose them
  InstanceLayout instances_;
  DevicePose on_device_;
  Expected<FrameResult> one_frame(const Job& job, const PlanContext& context, const WantedOutputs& wanted,
                                  double time_s, SubframeSums& sums);
  Expected<void> open_scene(const Job& job);
  // What of the job and its look belongs to the scene: paths and instances (docs/using/paths.md).
  Expected<void> follow_motion(const Job& job);
  Expected<void> read_sky(const std::string& sky_file, const std::string& look_file);
  JobSky sky_;
  std::string sky_file_, look_file_;  // that sky_ is of
  std::string motion_;                // paths and instances that scene_ has, as text
  std::vector<std::string> warnings_;
  std::unique_ptr<GpuScene> gpu_scene_;
};

}  // namespace candela
