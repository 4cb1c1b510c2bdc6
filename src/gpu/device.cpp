#include "gpu/device.h"

#include <bit>
#include <mutex>
#include <set>

#include "base/check.h"
#include "gpu/device_select.h"

namespace candela::gpu {

namespace {

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

// Messages of the installed layer (1.3.239) that are known to be wrong, with the reason. Only proven ones belong here.
struct FalsePositive {
  std::string_view message_id, reason;
};
constexpr std::array<FalsePositive, 0> false_positives{};

}  // namespace

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
  bool validate = false;
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
  PFN_vkSetDebugUtilsObjectNameEXT set_name = nullptr;
  PFN_vkCmdBeginDebugUtilsLabelEXT begin_label = nullptr;
  PFN_vkCmdEndDebugUtilsLabelEXT end_label = nullptr;
  PFN_vkDestroyDebugUtilsMessengerEXT destroy_messenger = nullptr;
  VkPhysicalDeviceMemoryProperties memory_types{};

  mutable std::mutex mutex;  // guards what follows
  std::vector<std::string> messages;
  std::set<std::string> seen;
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

  static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                                   VkDebugUtilsMessageTypeFlagsEXT,
                                                   const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    auto& self = *static_cast<Hidden*>(user);
    const std::string id = data->pMessageIdName ? data->pMessageIdName : "";
    for (const FalsePositive& known : false_positives)
      if (known.message_id == id) return VK_FALSE;
    std::string text = fmt::format("{}: {}", id, data->pMessage ? data->pMessage : "");
    std::lock_guard lock(self.mutex);
    if (self.seen.insert(text).second) self.messages.push_back(std::move(text));
    return VK_FALSE;
  }
};

namespace {

VkDebugUtilsMessengerCreateInfoEXT messenger_info(PFN_vkDebugUtilsMessengerCallbackEXT callback, void* user) {
  VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  info.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  // Not "general": there the loader reports drivers of other hardware that it could not open.
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  info.pfnUserCallback = callback;
  info.pUserData = user;
  return info;
}

template <class F>
F instance_function(VkInstance instance, const char* name) {
  return reinterpret_cast<F>(vkGetInstanceProcAddr(instance, name));
}

Expected<VkDevice> create_device(const Candidate& chosen, bool second_queue) {
  DeviceFeatures present, wanted;
  vkGetPhysicalDeviceFeatures2(chosen.physical, &present.core);
  enable_features(present, wanted);
  constexpr float priorities[] = {1, 1};
  std::vector<VkDeviceQueueCreateInfo> queues;
  const auto add_queues = [&](uint32_t family, uint32_t count) {
    VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue.queueFamilyIndex = family;
    queue.queueCount = count;
    queue.pQueuePriorities = priorities;
    queues.push_back(queue);
  };
  const bool same_family = chosen.compute_family == chosen.queue_family;
  add_queues(chosen.queue_family, second_queue && same_family ? 2 : 1);
  if (second_queue && !same_family) add_queues(chosen.compute_family, 1);
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &wanted.core};
  std::vector<const char*> extensions;
  const auto enable = [&](auto& feature, const char* extension) {
    feature.pNext = const_cast<void*>(info.pNext);
    info.pNext = &feature;
    extensions.push_back(extension);
  };
  VkPhysicalDeviceAccelerationStructureFeaturesKHR structures{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR};
  VkPhysicalDeviceRayQueryFeaturesKHR queries{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR};
  VkPhysicalDeviceRayTracingPipelineFeaturesKHR pipelines{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR};
  structures.accelerationStructure = queries.rayQuery = pipelines.rayTracingPipeline = VK_TRUE;
  const RayExtensions rays = ray_extensions(chosen.physical);
  if (rays.queries) enable(queries, VK_KHR_RAY_QUERY_EXTENSION_NAME);
  if (rays.pipelines) enable(pipelines, VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME);
  if (rays.queries || rays.pipelines) {
    enable(structures, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME);
    extensions.push_back(VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME);
  }
  if (has_post_depth_coverage(chosen.physical)) extensions.push_back(VK_EXT_POST_DEPTH_COVERAGE_EXTENSION_NAME);
  info.queueCreateInfoCount = uint32_t(queues.size());
  info.pQueueCreateInfos = queues.data();
  info.enabledExtensionCount = uint32_t(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  VkDevice device = VK_NULL_HANDLE;
  const VkResult result = vkCreateDevice(chosen.physical, &info, nullptr, &device);
  if (result != VK_SUCCESS)
    return std::unexpected(
        start_error(result, fmt::format("the device {} does not open: {}", chosen.info.name, result_name(result))));
  return device;
}

}  // namespace

Expected<std::vector<DeviceInfo>> list_devices() {
  const Expected<VkInstance> instance = create_instance(false, nullptr);
  if (!instance) return std::unexpected(instance.error());
  auto candidates = find_candidates(*instance);
  vkDestroyInstance(*instance, nullptr);
  if (!candidates) return std::unexpected(candidates.error());
  std::vector<DeviceInfo> devices;
  for (Candidate& candidate : *candidates) devices.push_back(std::move(candidate.info));
  return devices;
}

Expected<std::unique_ptr<Device>> Device::open(const DeviceOptions& options) {
  std::unique_ptr<Device> device(new Device);
  device->hidden_ = std::make_unique<Hidden>();
  Hidden& hidden = *device->hidden_;
  hidden.validate = options.validate;

  // The messenger in the chain hears vkCreateInstance and vkDestroyInstance themselves.
  VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_info(&Hidden::on_message, &hidden);
  const VkValidationFeatureEnableEXT checks[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT, &messenger};
  features.enabledValidationFeatureCount = uint32_t(std::size(checks));
  features.pEnabledValidationFeatures = checks;
  const Expected<VkInstance> instance = create_instance(options.validate, options.validate ? &features : nullptr);
  if (!instance) return std::unexpected(instance.error());
  device->instance_ = *instance;

  const auto candidates = find_candidates(*instance);
  if (!candidates) return std::unexpected(candidates.error());
  std::vector<DeviceInfo> infos;
  for (const Candidate& candidate : *candidates) infos.push_back(candidate.info);
  const Expected<int> index = choose_device(infos, options.which);
  if (!index) return std::unexpected(index.error());
  const Candidate& chosen = (*candidates)[size_t(*index)];
  const bool second_queue = chosen.second_queue && options.queues > 1;
  const Expected<VkDevice> handle = create_device(chosen, second_queue);
  if (!handle) return std::unexpected(handle.error());

  device->info_ = chosen.info;
  device->physical_ = chosen.physical;
  device->device_ = *handle;
  device->queue_family_ = chosen.queue_family;
  device->timestamp_period_ns_ = chosen.timestamp_period_ns;
  device->timestamp_mask_ = chosen.timestamp_bits >= 64 ? ~0ull : (1ull << chosen.timestamp_bits) - 1;
  vkGetDeviceQueue(*handle, chosen.queue_family, 0, &device->queue_);
  device->compute_family_ = second_queue ? chosen.compute_family : chosen.queue_family;
  device->compute_timestamps_ = (second_queue ? chosen.compute_timestamp_bits : chosen.timestamp_bits) > 0;
  vkGetDeviceQueue(*handle, device->compute_family_, second_queue ? chosen.compute_index : 0, &device->compute_queue_);
  if (device->compute_family_ != device->queue_family_)
    device->shared_families_ = {device->queue_family_, device->compute_family_};
  vkGetPhysicalDeviceMemoryProperties(chosen.physical, &hidden.memory_types);
  if (options.validate) {
    const auto create =
        instance_function<PFN_vkCreateDebugUtilsMessengerEXT>(*instance, "vkCreateDebugUtilsMessengerEXT");
    hidden.destroy_messenger =
        instance_function<PFN_vkDestroyDebugUtilsMessengerEXT>(*instance, "vkDestroyDebugUtilsMessengerEXT");
    hidden.set_name = instance_function<PFN_vkSetDebugUtilsObjectNameEXT>(*instance, "vkSetDebugUtilsObjectNameEXT");
    hidden.begin_label = instance_function<PFN_vkCmdBeginDebugUtilsLabelEXT>(*instance, "vkCmdBeginDebugUtilsLabelEXT");
    hidden.end_label = instance_function<PFN_vkCmdEndDebugUtilsLabelEXT>(*instance, "vkCmdEndDebugUtilsLabelEXT");
    VK_CHECK(create(*instance, &messenger, nullptr, &hidden.messenger));
  }
  return device;
}

Device::~Device() {
  if (device_) {
    vkDeviceWaitIdle(device_);
    vkDestroyDevice(device_, nullptr);
  }
  if (hidden_ && hidden_->messenger) hidden_->destroy_messenger(instance_, hidden_->messenger, nullptr);
  if (instance_) vkDestroyInstance(instance_, nullptr);
}

std::vector<std::string> Device::validation_messages() const {
  std::lock_guard lock(hidden_->mutex);
  return hidden_->messages;
}

void Device::set_name(VkObjectType type, uint64_t handle, std::string_view name) const {
  if (!hidden_->set_name) return;
  const std::string text(name);
  VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
  info.objectType = type;
  info.objectHandle = handle;
  info.pObjectName = text.c_str();
  VK_CHECK(hidden_->set_name(device_, &info));
}

void Device::begin_label(VkCommandBuffer commands, const std::string& name) const {
  if (!hidden_->begin_label) return;
  VkDebugUtilsLabelEXT label{VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT};
  label.pLabelName = name.c_str();
  hidden_->begin_label(commands, &label);
}

void Device::end_label(VkCommandBuffer commands) const {
  if (hidden_->end_label) hidden_->end_label(commands);
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
