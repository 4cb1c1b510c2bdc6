#include "gpu/device.h"

#include <bit>
#include <mutex>

#include "base/check.h"
#include "gpu/shared_device.h"

namespace candela::gpu {

std::string result_name(VkResult result) {
  switch (result) {
    case VK_TIMEOUT:
      return "timeout";
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "out of host memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "out of device memory";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "initialization failed";
    case VK_ERROR_DEVICE_LOST:
      return "device lost";
    case VK_ERROR_MEMORY_MAP_FAILED:
      return "memory could not be mapped";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "layer not present";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "extension not present";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "feature not present";
    case VK_ERROR_TOO_MANY_OBJECTS:
      return "too many objects";
    case VK_ERROR_FORMAT_NOT_SUPPORTED:
      return "format not supported";
    case VK_ERROR_FRAGMENTED_POOL:
      return "fragmented pool";
    case VK_ERROR_OUT_OF_POOL_MEMORY:
      return "out of pool memory";
    default:
      return fmt::format("error {}", int(result));
  }
}

GpuError::GpuError(VkResult r, const std::string& what)
    : std::runtime_error(fmt::format("{}: {}", what, result_name(r))), result(r) {}

void vk_check(VkResult result, const char* call) {
  if (result < 0) {
    // The name of the function says enough; its arguments are ours.
    const std::string_view text(call);
    throw GpuError(result, std::string(text.substr(0, text.find('('))));
  }
}

struct Device::Hidden {
  struct Allocation {
    uint64_t bytes;
    Purpose purpose;
  };
  std::shared_ptr<OpenDevice> open;
  MessageLog log;
  VkPhysicalDeviceMemoryProperties memory_types{};

  mutable std::mutex mutex;  // guards what follows
  std::map<VkDeviceMemory, Allocation> allocations;
  MemoryUse use;
  uint64_t uploaded = 0;

  uint64_t& of(Purpose purpose) {
    switch (purpose) {
      case Purpose::scene:
        return use.scene;
      case Purpose::frame:
        return use.frame;
      case Purpose::readback:
        return use.readback;
      default:
        return use.staging;
    }
  }
};

Expected<std::vector<DeviceInfo>> list_devices() {
  const auto instance = shared_instance(false);
  if (!instance) return std::unexpected(instance.error());
  std::vector<DeviceInfo> devices;
  for (const Candidate& candidate : (*instance)->candidates) devices.push_back(candidate.info);
  return devices;
}

Expected<std::unique_ptr<Device>> Device::open(const DeviceOptions& options) {
  const auto opened = shared_device(options.validate, options.which);
  if (!opened) return std::unexpected(opened.error());
  const Candidate& chosen = (*opened)->chosen;
  const bool second_queue = chosen.second_queue && options.queues > 1;
  std::unique_ptr<Device> device(new Device);
  device->hidden_ = std::make_unique<Hidden>();
  device->hidden_->open = *opened;
  (*opened)->instance->attach(&device->hidden_->log);
  device->info_ = chosen.info;
  device->instance_ = (*opened)->instance->handle;
  device->physical_ = chosen.physical;
  device->device_ = (*opened)->handle;
  device->queue_family_ = chosen.queue_family;
  device->timestamp_period_ns_ = chosen.timestamp_period_ns;
  device->timestamp_mask_ = chosen.timestamp_bits >= 64 ? ~0ull : (1ull << chosen.timestamp_bits) - 1;
  vkGetDeviceQueue(device->device_, chosen.queue_family, 0, &device->queue_);
  device->compute_family_ = second_queue ? chosen.compute_family : chosen.queue_family;
  device->compute_timestamps_ = (second_queue ? chosen.compute_timestamp_bits : chosen.timestamp_bits) > 0;
  vkGetDeviceQueue(device->device_, device->compute_family_, second_queue ? chosen.compute_index : 0,
                   &device->compute_queue_);
  if (device->compute_family_ != device->queue_family_)
    device->shared_families_ = {device->queue_family_, device->compute_family_};
  vkGetPhysicalDeviceMemoryProperties(chosen.physical, &device->hidden_->memory_types);
  return device;
}

Device::~Device() {
  if (!hidden_) return;
  vkDeviceWaitIdle(device_);
  hidden_->open->instance->detach(&hidden_->log);
}

PipelineStore& Device::store() const { return *hidden_->open->store; }

std::vector<std::string> Device::validation_messages() const { return hidden_->log.messages(); }

void Device::set_name(VkObjectType type, uint64_t handle, std::string_view name) const {
  const auto set = hidden_->open->instance->set_name;
  if (!set) return;
  const std::string text(name);
  VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
  info.objectType = type;
  info.objectHandle = handle;
  info.pObjectName = text.c_str();
  VK_CHECK(set(device_, &info));
}

void Device::begin_label(VkCommandBuffer commands, const std::string& name) const {
  const auto begin = hidden_->open->instance->begin_label;
  if (!begin) return;
  VkDebugUtilsLabelEXT label{VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT};
  label.pLabelName = name.c_str();
  begin(commands, &label);
}

void Device::end_label(VkCommandBuffer commands) const {
  if (const auto end = hidden_->open->instance->end_label) end(commands);
}

Device::MemoryUse Device::memory_use() const {
  std::lock_guard lock(hidden_->mutex);
  return hidden_->use;
}

uint64_t Device::uploaded_bytes() const {
  std::lock_guard lock(hidden_->mutex);
  return hidden_->uploaded;
}

void Device::count_uploaded(uint64_t bytes) {
  std::lock_guard lock(hidden_->mutex);
  hidden_->uploaded += bytes;
}

VkDeviceMemory Device::allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted,
                                VkMemoryPropertyFlags preferred, Purpose purpose) {
  const VkPhysicalDeviceMemoryProperties& types = hidden_->memory_types;
  int best = -1, best_score = -1;
  for (uint32_t i = 0; i < types.memoryTypeCount; ++i) {
    const VkMemoryPropertyFlags flags = types.memoryTypes[i].propertyFlags;
    if (!(needs.memoryTypeBits & (1u << i)) || (flags & wanted) != wanted) continue;
    const int score = std::popcount(flags & preferred);
    if (score > best_score) best = int(i), best_score = score;
  }
  if (best < 0) throw GpuError(VK_ERROR_FEATURE_NOT_PRESENT, "no memory type fits");
  VkMemoryAllocateFlagsInfo flags{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO};
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, &flags, needs.size, uint32_t(best)};
  VkDeviceMemory memory = VK_NULL_HANDLE;
  const VkResult result = vkAllocateMemory(device_, &info, nullptr, &memory);
  if (result != VK_SUCCESS)
    throw GpuError(result, fmt::format("allocating {} MiB", (needs.size + (1 << 20) - 1) >> 20));
  std::lock_guard lock(hidden_->mutex);
  hidden_->allocations[memory] = {needs.size, purpose};
  hidden_->of(purpose) += needs.size;
  MemoryUse& use = hidden_->use;
  use.peak = std::max(use.peak, use.scene + use.frame + use.readback + use.staging);
  return memory;
}

void Device::release(VkDeviceMemory memory) {
  if (!memory) return;
  {
    std::lock_guard lock(hidden_->mutex);
    const auto found = hidden_->allocations.find(memory);
    CHECK(found != hidden_->allocations.end());
    hidden_->of(found->second.purpose) -= found->second.bytes;
    hidden_->allocations.erase(found);
  }
  vkFreeMemory(device_, memory, nullptr);
}

}  // namespace candela::gpu
