#pragma once
#include <string>
#include <vector>

#include "base/error.h"
#include "gpu/frame_runner.h"
#include "plan/plan_frame.h"
#include "session/gpu_scene.h"

namespace candela {

// Draws the reflection probes of a planned frame's look, six frames each, and gives the scene their filtered images in
// the place of those that it has. They depend on the job, its scene and their own times, and on no frame. context: the
// planned frame's, without rays. Waits for the device. Throws GpuError.
Expected<void> draw_probes(const Job& job, PlanContext context, const PlannedFrame& planned, gpu::FrameRunner& runner,
                           GpuScene& gpu_scene, std::vector<std::string>& warnings);

}  // namespace candela
