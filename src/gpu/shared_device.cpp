#include "gpu/shared_device.h"

#include <cstdlib>
#include <map>

namespace candela::gpu {
namespace {

// Messages of the installed layer (1.3.239) that are known to be wrong, with the reason. Only proven ones belong here.
struct FalsePositive {
  std::string_view message_id, reason;
};
constexpr std::array<FalsePositive, 0> false_positives{};

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  const std::string id = data->pMessageIdName ? data->pMessageIdName : "";
  for (const FalsePositive& known : false_positives)
    if (known.message_id == id) return VK_FALSE;
  static_cast<OpenInstance*>(user)->pass_on(fmt::format("{}: {}", id, data->pMessage ? data->pMessage : ""));
  return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(OpenInstance* user) {
  VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  info.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  // Not "general": there the loader reports drivers of other hardware that it could not open.
  info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
  info.pfnUserCallback = on_message;
  info.pUserData = user;
  return info;
}

template <class F>
F instance_function(VkInstance instance, const char* name) {
  return reinterpret_cast<F>(vkGetInstanceProcAddr(instance, name));
}

// One of each kind is opened, and closed when the process ends.
struct Shared {
  std::mutex mutex;                                                     // guards what follows
  std::map<bool, std::shared_ptr<OpenInstance>> instances;              // by whether they validate
  std::map<std::pair<bool, int>, std::shared_ptr<OpenDevice>> devices;  // and by index
};
Shared& shared() {
  static Shared* const all = new Shared;  // closed by close_all, before the libraries of drivers and layers are
  return *all;
}
void close_all() {
  shared().devices.clear();
  shared().instances.clear();
}

Expected<std::shared_ptr<OpenInstance>> instance_of(Shared& all, bool validate) {
  std::shared_ptr<OpenInstance>& kept = all.instances[validate];
  if (kept) return kept;
  auto instance = std::make_shared<OpenInstance>();
  if (auto opened = instance->open(validate); !opened) return std::unexpected(opened.error());
  if (instance->candidates.empty()) return instance;  // looked for again the next time
  [[maybe_unused]] static const int closes = std::atexit(close_all);
  return kept = std::move(instance);
}

}  // namespace

Expected<VkDevice> create_device(const Candidate& chosen) {
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
  add_queues(chosen.queue_family, chosen.second_queue && same_family ? 2 : 1);
  if (chosen.second_queue && !same_family) add_queues(chosen.compute_family, 1);
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
  const RayExtensions rays = chosen.info.rays;
  if (rays.queries) enable(queries, VK_KHR_RAY_QUERY_EXTENSION_NAME);
  if (rays.pipelines) enable(pipelines, VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME);
  if (rays.queries || rays.pipelines) {
    enable(structures, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME);
    extensions.push_back(VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME);
  }
  if (chosen.info.post_depth_coverage) extensions.push_back(VK_EXT_POST_DEPTH_COVERAGE_EXTENSION_NAME);
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

void MessageLog::add(const std::string& message) {
  std::lock_guard lock(mutex_);
  if (seen_.insert(message).second) messages_.push_back(message);
}

std::vector<std::string> MessageLog::messages() const {
  std::lock_guard lock(mutex_);
  return messages_;
}

void OpenInstance::attach(MessageLog* log) {
  std::lock_guard lock(mutex_);
  logs_.insert(log);
}
void OpenInstance::detach(MessageLog* log) {
  std::lock_guard lock(mutex_);
  logs_.erase(log);
}
void OpenInstance::pass_on(const std::string& message) {
  std::lock_guard lock(mutex_);
  for (MessageLog* log : logs_) log->add(message);
}

Expected<void> OpenInstance::open(bool validate) {
  // The messenger in the chain hears vkCreateInstance and vkDestroyInstance themselves.
  VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_info(this);
  const VkValidationFeatureEnableEXT checks[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT, &messenger};
  features.enabledValidationFeatureCount = uint32_t(std::size(checks));
  features.pEnabledValidationFeatures = checks;
  const Expected<VkInstance> instance = create_instance(validate, validate ? &features : nullptr);
  if (!instance) return std::unexpected(instance.error());
  handle = *instance;
  auto found = find_candidates(handle);
  if (!found) return std::unexpected(found.error());
  candidates = std::move(*found);
  if (!validate) return {};
  const auto create = instance_function<PFN_vkCreateDebugUtilsMessengerEXT>(handle, "vkCreateDebugUtilsMessengerEXT");
  destroy_messenger_ =
      instance_function<PFN_vkDestroyDebugUtilsMessengerEXT>(handle, "vkDestroyDebugUtilsMessengerEXT");
  set_name = instance_function<PFN_vkSetDebugUtilsObjectNameEXT>(handle, "vkSetDebugUtilsObjectNameEXT");
  begin_label = instance_function<PFN_vkCmdBeginDebugUtilsLabelEXT>(handle, "vkCmdBeginDebugUtilsLabelEXT");
  end_label = instance_function<PFN_vkCmdEndDebugUtilsLabelEXT>(handle, "vkCmdEndDebugUtilsLabelEXT");
  if (const VkResult result = create(handle, &messenger, nullptr, &messenger_); result != VK_SUCCESS)
    return std::unexpected(start_error(
        result,
        fmt::format("the validation layer does not start (vkCreateDebugUtilsMessengerEXT: {})", result_name(result))));
  return {};
}

OpenInstance::~OpenInstance() {
  if (messenger_) destroy_messenger_(handle, messenger_, nullptr);
  if (handle) vkDestroyInstance(handle, nullptr);
}

OpenDevice::~OpenDevice() {
  if (!handle) return;
  vkDeviceWaitIdle(handle);
  store.reset();
  vkDestroyDevice(handle, nullptr);
}

Expected<std::shared_ptr<OpenInstance>> shared_instance(bool validate) {
  std::lock_guard lock(shared().mutex);
  return instance_of(shared(), validate);
}

std::optional<Candidate> candidate_without_validation(VkInstance instance, VkPhysicalDevice device) {
  std::lock_guard lock(shared().mutex);
  const auto found = shared().instances.find(false);
  if (found == shared().instances.end() || !found->second || found->second->handle != instance) return {};
  for (const Candidate& candidate : found->second->candidates)
    if (candidate.physical == device) return candidate;
  return {};
}

Expected<std::shared_ptr<OpenDevice>> shared_device(bool validate, std::string_view which) {
  Shared& all = shared();
  std::lock_guard lock(all.mutex);
  const auto instance = instance_of(all, validate);
  if (!instance) return std::unexpected(instance.error());
  std::vector<DeviceInfo> infos;
  for (const Candidate& candidate : (*instance)->candidates) infos.push_back(candidate.info);
  const Expected<int> index = choose_device(infos, which);
  if (!index) return std::unexpected(index.error());
  std::shared_ptr<OpenDevice>& kept = all.devices[{validate, *index}];
  if (kept && vkDeviceWaitIdle(kept->handle) != VK_ERROR_DEVICE_LOST) return kept;
  auto device = std::make_shared<OpenDevice>();
  device->instance = *instance;
  device->chosen = (*instance)->candidates[size_t(*index)];
  const Expected<VkDevice> handle = create_device(device->chosen);
  if (!handle) return std::unexpected(handle.error());
  device->handle = *handle;
  device->store = std::make_unique<PipelineStore>(*handle);
  return kept = std::move(device);
}

}  // namespace candela::gpu
