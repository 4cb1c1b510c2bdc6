#pragma once
#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace candela::gpu {

// A Vulkan call failed in the middle of a frame; only the top can act. Caught once per frame or sweep row.
// out_of_memory tells exit code 6 from 4.
class GpuError : public std::runtime_error {
 public:
  GpuError(VkResult result, const std::string& what);
  VkResult result;
  std::string place;  // the file that it befell; empty: none
  bool out_of_memory() const {
    return result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY;
  }
};
std::string result_name(VkResult result);          // "device lost"
void vk_check(VkResult result, const char* call);  // throws GpuError
#define VK_CHECK(call) ::candela::gpu::vk_check((call), #call)

// Rays through the device's own trees, which are of no version of Vulkan: on where they are present.
struct RayExtensions {
  bool queries = false, pipelines = false;  // with acceleration structures
};

struct DeviceInfo {
  int index = 0;             // in list_devices order
  std::string name, driver;  // "llvmpipe (LLVM 15.0.6, 256 bits)", "llvmpipe Mesa 25.0.7"
  std::string type;          // "cpu", "integrated", "discrete", "virtual", "other"
  std::string uuid;          // 32 hex digits
  std::string device_class;  // goldens and reports group by it: "lavapipe", "nvidia", ... (driver family, lower case)
  uint32_t api_major = 0, api_minor = 0, subgroup_size = 0;
  uint32_t subpixel_bits = 0;  // corners of triangles are rounded to 2^-bits of a pixel before they are drawn
  uint64_t memory_bytes = 0;
  bool is_cpu = false;
  bool post_depth_coverage = false;  // a fragment's coverage after the depth test
  bool int64_atomics = false;        // in buffers, as --technique visibility needs them
  uint64_t paged_bytes = 0;          // of images and buffers that may lie on pages (gpu/pages.h); 0: none may
  RayExtensions rays;
  std::string unusable;  // empty, or what it lacks and what to install
};

class PipelineStore;

struct DeviceOptions {
  std::string which;  // "": the best GPU, else the CPU device. "cpu", "gpu", an index, a UUID, part of a name: or fail
  bool validate = false;  // Khronos validation layer with synchronization checks; its absence is an error
  int queues = 2;         // 1: no second queue, whatever the device has
};

Expected<std::vector<DeviceInfo>> list_devices();

// The Vulkan instance, device and its graphics+compute queue, and beside it a second one for compute where the device
// has one. No window, no surface. Instance and device are the process's own (gpu/shared_device.h): each Device counts
// what goes through it, and all of them are used by one thread at a time.
class Device {
 public:
  // Errors (device): no Vulkan, nothing that matches (lists what there is), a feature missing (names it and the fix:
  // lavapipe before Mesa 23 has no descriptor indexing).
  static Expected<std::unique_ptr<Device>> open(const DeviceOptions& options);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const { return info_; }
  VkInstance instance() const { return instance_; }
  VkPhysicalDevice physical() const { return physical_; }
  VkDevice handle() const { return device_; }
  VkQueue queue() const { return queue_; }
  uint32_t queue_family() const { return queue_family_; }
  VkQueue compute_queue() const { return compute_queue_; }  // the same one where there is no second
  uint32_t compute_family() const { return compute_family_; }
  bool has_second_queue() const { return compute_queue_ != queue_; }
  bool compute_timestamps() const { return compute_timestamps_; }
  // The families that share what both queues use; empty where one family serves both. What is made for them is
  // CONCURRENT: no ownership changes hands, so no release and acquire have to meet. It costs nothing for buffers, and
  // for images on the devices known to have such queues, but for compression on some, so images that one queue uses
  // alone stay exclusive.
  std::span<const uint32_t> shared_families() const { return shared_families_; }
  double timestamp_period_ns() const { return timestamp_period_ns_; }
  uint64_t timestamp_mask() const { return timestamp_mask_; }  // 0: the queue has no timestamps
  // Messages of the validation layer so far (warnings and errors), each once. Any message fails a test or a --validate
  // job.
  std::vector<std::string> validation_messages() const;

  // What all Devices of this process on the same VkDevice share.
  PipelineStore& store() const;

  // Of an extension that is on.
  template <class Function>
  Function function(const char* name) const {
    return reinterpret_cast<Function>(vkGetDeviceProcAddr(device_, name));
  }

  // For the messages of the validation layer and for debuggers; without validation they do nothing.
  void set_name(VkObjectType type, uint64_t handle, std::string_view name) const;
  void begin_label(VkCommandBuffer commands, const std::string& name) const;
  void end_label(VkCommandBuffer commands) const;

  // Memory in use now and at its highest, by purpose (for --timings).
  struct MemoryUse {
    uint64_t scene = 0, frame = 0, readback = 0, staging = 0, peak = 0;
  };
  MemoryUse memory_use() const;
  // What the host sent so far: copied into memory that the device reads in place, or through staging memory.
  uint64_t uploaded_bytes() const;
  void count_uploaded(uint64_t bytes);
  enum class Purpose { scene, frame, readback, staging };
  VkDeviceMemory allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted,
                          VkMemoryPropertyFlags preferred, Purpose purpose);
  void release(VkDeviceMemory memory);

 private:
  Device() = default;
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
  DeviceInfo info_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  VkQueue compute_queue_ = VK_NULL_HANDLE;
  uint32_t queue_family_ = 0, compute_family_ = 0;
  bool compute_timestamps_ = false;
  std::vector<uint32_t> shared_families_;
  double timestamp_period_ns_ = 1;
  uint64_t timestamp_mask_ = 0;
};

}  // namespace candela::gpu
