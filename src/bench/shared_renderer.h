#pragma once
#include <memory>

#include "bench/picture.h"
#include "gpu/frame_runner.h"
#include "render/gpu_scene.h"
#include "render/plan_frame.h"

namespace candela {

// Renders many small scenes on one device with one set of pipelines, which a Session makes anew for each job.
class SharedRenderer {
 public:
  static Expected<std::unique_ptr<SharedRenderer>> open(const RunSettings& settings);
  ~SharedRenderer();

  Expected<void> load(const std::string& scene_file);
  // The linear picture of the loaded scene. GpuError becomes an Error here.
  Expected<Beauty> render(const Job& job, double time_s);
  const gpu::DeviceInfo& device() const { return device_->info(); }

 private:
  SharedRenderer() = default;
  RunSettings settings_;
  std::unique_ptr<gpu::Device> device_;
  std::unique_ptr<gpu::Bindless> bindless_;
  std::unique_ptr<gpu::FrameRunner> runner_;
  Scene scene_;
  GeometryLayout layout_;
  std::unique_ptr<GpuScene> gpu_scene_;
};

}  // namespace candela
