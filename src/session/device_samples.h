#pragma once
#include <vector>

#include "base/error.h"
#include "gpu/device.h"
#include "gpu/device_select.h"
#include "job/choose_transparency.h"
#include "job/job.h"
#include "passes/shared/bvh_knobs.h"

namespace candela {

// Samples a pixel that the device can draw the scene's colour and depth with, in ascending order. Vulkan promises 1
// and 4.
std::vector<int> device_samples(const gpu::Device& device);
// Whether the device runs shaders on a CPU, by subgroups of eight or more (PlanContext::cpu).
bool shades_on_cpu(const gpu::Device& device);

// An error (device) where the job wants another number: drawn with a count that it lacks, a device may leave samples
// out, and light with them, and say nothing.
Expected<void> check_samples(const Job& job, const std::vector<int>& possible, const std::string& device);

// Whether compute stores into multisampled images of the job's samples. An error (device) where a knob asks for it and
// the device does not.
Expected<bool> stores_samples(const Job& job, const gpu::Device& device);

// What choose_transparency() asks of the device, and the job's samples a pixel.
struct TransparencyLimits {
  TransparencyDevice device;
  int samples = 1;
};
Expected<TransparencyLimits> transparency_device(const Job& job, const gpu::Device& device);

// An error (device) where rays are to be traced in a way that the device lacks.
Expected<void> check_traversal(const BvhKnobs& knobs, const gpu::RayExtensions& has, const std::string& device);

}  // namespace candela
