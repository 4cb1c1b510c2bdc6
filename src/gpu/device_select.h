#pragma once
#include <vulkan/vulkan_core.h>

#include <span>
#include <string_view>
#include <vector>

#include "gpu/device.h"

// Finding the device: what there is, what it lacks, which one is meant.
namespace candela::gpu {

// The features that every frame may use. Copies would point at the wrong chain, so there are none.
struct DeviceFeatures {
  DeviceFeatures();
  DeviceFeatures(const DeviceFeatures&) = delete;
  DeviceFeatures& operator=(const DeviceFeatures&) = delete;
  VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  VkPhysicalDeviceVulkan11Features v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
};
// Names of required features that `present` has not, separated by commas; empty when it has all.
std::string missing_features(const DeviceFeatures& present);
// Sets in `wanted` all required features, and the optional ones that `present` has.
void enable_features(const DeviceFeatures& present, DeviceFeatures& wanted);

// shaderBufferInt64Atomics, which is on where it is present.
bool has_int64_atomics(VkPhysicalDevice physical);
// Whether fragment shaders know their primitive (geometryShader, for gl_PrimitiveID).
bool has_primitive_ids(VkPhysicalDevice physical);
// Whether shaders can compute in double.
bool has_float64(VkPhysicalDevice physical);

struct Candidate {
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  DeviceInfo info;
  uint32_t queue_family = 0;
  // A second queue that computes beside the first: of a family without graphics where there is one, else one more of
  // the first one's.
  bool second_queue = false;
  uint32_t compute_family = 0, compute_index = 0, compute_timestamp_bits = 0;
  uint32_t timestamp_bits = 0;
  double timestamp_period_ns = 1;
};
Expected<std::vector<Candidate>> find_candidates(VkInstance instance);

// Sets the queues of a candidate from its families; false where none does graphics and compute. Pure.
bool choose_queues(std::span<const VkQueueFamilyProperties> families, Candidate& candidate);

// Index into `devices` of the one that `which` means (DeviceOptions::which). Pure.
Expected<int> choose_device(std::span<const DeviceInfo> devices, std::string_view which);

Expected<VkInstance> create_instance(bool validate, const void* next);

// Why Vulkan did not start: out of memory where memory or threads ran out, which loaders and drivers report as a driver
// or a device that is not there, else an error of the device with `message`.
Error start_error(VkResult result, std::string message);

}  // namespace candela::gpu
