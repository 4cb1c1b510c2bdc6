#include "gpu/device_select.h"

#include <algorithm>
#include <cctype>
#include <cstring>

#include "base/process.h"
#include "base/text.h"
#include "gpu/driver_files.h"
#include "gpu/pages.h"

namespace candela::gpu {

namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

template <class T>
struct Feature {
  const char* name;
  VkBool32 T::*member;
};
// clang-format off
constexpr Feature<VkPhysicalDeviceFeatures> required_core[] = {
    {"shaderInt64", &VkPhysicalDeviceFeatures::shaderInt64},
    {"multiDrawIndirect", &VkPhysicalDeviceFeatures::multiDrawIndirect},
    {"drawIndirectFirstInstance", &VkPhysicalDeviceFeatures::drawIndirectFirstInstance},
    {"shaderStorageImageWriteWithoutFormat", &VkPhysicalDeviceFeatures::shaderStorageImageWriteWithoutFormat},
    {"shaderStorageImageReadWithoutFormat", &VkPhysicalDeviceFeatures::shaderStorageImageReadWithoutFormat},
    {"shaderSampledImageArrayDynamicIndexing", &VkPhysicalDeviceFeatures::shaderSampledImageArrayDynamicIndexing},
    {"shaderStorageImageArrayDynamicIndexing", &VkPhysicalDeviceFeatures::shaderStorageImageArrayDynamicIndexing},
    {"fragmentStoresAndAtomics", &VkPhysicalDeviceFeatures::fragmentStoresAndAtomics},
    {"independentBlend", &VkPhysicalDeviceFeatures::independentBlend},
    {"sampleRateShading", &VkPhysicalDeviceFeatures::sampleRateShading},  // values at samples, of masks by sample
};
constexpr Feature<VkPhysicalDeviceFeatures> optional_core[] = {
    {"samplerAnisotropy", &VkPhysicalDeviceFeatures::samplerAnisotropy},
    {"geometryShader", &VkPhysicalDeviceFeatures::geometryShader},  // gl_PrimitiveID in fragment shaders
    {"depthClamp", &VkPhysicalDeviceFeatures::depthClamp},
    {"vertexPipelineStoresAndAtomics", &VkPhysicalDeviceFeatures::vertexPipelineStoresAndAtomics},
    {"textureCompressionBC", &VkPhysicalDeviceFeatures::textureCompressionBC},
    {"shaderFloat64", &VkPhysicalDeviceFeatures::shaderFloat64},
    {"shaderInt16", &VkPhysicalDeviceFeatures::shaderInt16},
    // Samples that compute shades; without it they go through a buffer.
    {"shaderStorageImageMultisample", &VkPhysicalDeviceFeatures::shaderStorageImageMultisample},
    {"imageCubeArray", &VkPhysicalDeviceFeatures::imageCubeArray},
    // Memory by pages (gpu/pages.h).
    {"sparseBinding", &VkPhysicalDeviceFeatures::sparseBinding},
    {"sparseResidencyBuffer", &VkPhysicalDeviceFeatures::sparseResidencyBuffer},
    {"sparseResidencyImage2D", &VkPhysicalDeviceFeatures::sparseResidencyImage2D},
    {"sparseResidency2Samples", &VkPhysicalDeviceFeatures::sparseResidency2Samples},
    {"sparseResidency4Samples", &VkPhysicalDeviceFeatures::sparseResidency4Samples},
    {"sparseResidency8Samples", &VkPhysicalDeviceFeatures::sparseResidency8Samples},
    {"sparseResidency16Samples", &VkPhysicalDeviceFeatures::sparseResidency16Samples},
    {"sparseResidencyAliased", &VkPhysicalDeviceFeatures::sparseResidencyAliased},
};
constexpr Feature<VkPhysicalDeviceVulkan11Features> required_11[] = {
    {"shaderDrawParameters", &VkPhysicalDeviceVulkan11Features::shaderDrawParameters},
};
constexpr Feature<VkPhysicalDeviceVulkan12Features> required_12[] = {
    {"descriptorIndexing", &VkPhysicalDeviceVulkan12Features::descriptorIndexing},
    {"runtimeDescriptorArray", &VkPhysicalDeviceVulkan12Features::runtimeDescriptorArray},
    {"descriptorBindingPartiallyBound", &VkPhysicalDeviceVulkan12Features::descriptorBindingPartiallyBound},
    {"descriptorBindingSampledImageUpdateAfterBind",
     &VkPhysicalDeviceVulkan12Features::descriptorBindingSampledImageUpdateAfterBind},
    {"descriptorBindingStorageImageUpdateAfterBind",
     &VkPhysicalDeviceVulkan12Features::descriptorBindingStorageImageUpdateAfterBind},
    {"descriptorBindingUpdateUnusedWhilePending",
     &VkPhysicalDeviceVulkan12Features::descriptorBindingUpdateUnusedWhilePending},
    {"timelineSemaphore", &VkPhysicalDeviceVulkan12Features::timelineSemaphore},
    {"shaderSampledImageArrayNonUniformIndexing",
     &VkPhysicalDeviceVulkan12Features::shaderSampledImageArrayNonUniformIndexing},
    {"bufferDeviceAddress", &VkPhysicalDeviceVulkan12Features::bufferDeviceAddress},
    {"scalarBlockLayout", &VkPhysicalDeviceVulkan12Features::scalarBlockLayout},
    {"drawIndirectCount", &VkPhysicalDeviceVulkan12Features::drawIndirectCount},
    {"hostQueryReset", &VkPhysicalDeviceVulkan12Features::hostQueryReset},
};
constexpr Feature<VkPhysicalDeviceVulkan12Features> optional_12[] = {
    {"shaderOutputLayer", &VkPhysicalDeviceVulkan12Features::shaderOutputLayer},
    {"shaderBufferInt64Atomics", &VkPhysicalDeviceVulkan12Features::shaderBufferInt64Atomics},
};
constexpr Feature<VkPhysicalDeviceVulkan13Features> required_13[] = {
    {"synchronization2", &VkPhysicalDeviceVulkan13Features::synchronization2},
    {"dynamicRendering", &VkPhysicalDeviceVulkan13Features::dynamicRendering},
    {"maintenance4", &VkPhysicalDeviceVulkan13Features::maintenance4},
    {"shaderDemoteToHelperInvocation", &VkPhysicalDeviceVulkan13Features::shaderDemoteToHelperInvocation},
};
// clang-format on

template <class T, size_t N>
void list_missing(const T& present, const Feature<T> (&required)[N], std::string& missing) {
  for (const Feature<T>& feature : required)
    if (!(present.*feature.member)) missing += (missing.empty() ? "" : ", ") + std::string(feature.name);
}

template <class T, size_t N>
void enable(T& wanted, const Feature<T> (&features)[N], const T* if_present = nullptr) {
  for (const Feature<T>& feature : features)
    if (!if_present || if_present->*feature.member) wanted.*feature.member = VK_TRUE;
}

std::string type_name(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "cpu";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated";
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "discrete";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual";
    default:
      return "other";
  }
}

std::string driver_class(VkDriverId id) {
  switch (id) {
    case VK_DRIVER_ID_MESA_LLVMPIPE:
      return "lavapipe";
    case VK_DRIVER_ID_NVIDIA_PROPRIETARY:
      return "nvidia";
    case VK_DRIVER_ID_MESA_RADV:
      return "radv";
    case VK_DRIVER_ID_AMD_PROPRIETARY:
    case VK_DRIVER_ID_AMD_OPEN_SOURCE:
      return "amd";
    case VK_DRIVER_ID_INTEL_OPEN_SOURCE_MESA:
      return "anv";
    case VK_DRIVER_ID_INTEL_PROPRIETARY_WINDOWS:
      return "intel";
    case VK_DRIVER_ID_GOOGLE_SWIFTSHADER:
      return "swiftshader";
    case VK_DRIVER_ID_MESA_VENUS:
      return "venus";
    case VK_DRIVER_ID_MOLTENVK:
      return "moltenvk";
    default:
      return "other";
  }
}

// Lower is better.
int rank(const DeviceInfo& info) {
  if (info.type == "discrete") return 0;
  if (info.type == "integrated") return 1;
  if (info.type == "virtual") return 2;
  return info.is_cpu ? 4 : 3;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = char(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

bool all_digits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c); });
}

std::string describe(std::span<const DeviceInfo> devices) {
  if (devices.empty()) return no_driver();
  std::string text = "there is ";
  for (const DeviceInfo& device : devices)
    text += fmt::format("{}{}: {} ({}{})", &device == devices.data() ? "" : ", ", device.index, device.name,
                        device.type, device.unusable.empty() ? "" : ", unusable: " + device.unusable);
  return text;
}

bool matches(const DeviceInfo& device, std::string_view which) {
  if (which.empty()) return true;
  const std::string wanted = lower(which);
  if (wanted == "cpu") return device.is_cpu;
  if (wanted == "gpu") return !device.is_cpu;
  if (all_digits(wanted) && wanted.size() <= 2) return device.index == std::stoi(wanted);
  std::string uuid = wanted;
  std::erase(uuid, '-');
  return uuid == device.uuid || lower(device.name).find(wanted) != std::string::npos;
}

DeviceInfo describe_physical(VkPhysicalDevice physical, int index) {
  VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
  VkPhysicalDeviceVulkan12Properties v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES, &v11};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  VkPhysicalDeviceProperties basic;
  vkGetPhysicalDeviceProperties(physical, &basic);
  if (basic.apiVersion >= VK_API_VERSION_1_2) properties.pNext = &v12;
  vkGetPhysicalDeviceProperties2(physical, &properties);

  DeviceInfo info;
  info.index = index;
  info.name = basic.deviceName;
  info.type = type_name(basic.deviceType);
  info.is_cpu = basic.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  info.driver = fmt::format("{} {}", v12.driverName, v12.driverInfo);
  info.device_class = driver_class(v12.driverID);
  info.api_major = VK_API_VERSION_MAJOR(basic.apiVersion);
  info.api_minor = VK_API_VERSION_MINOR(basic.apiVersion);
  info.subgroup_size = v11.subgroupSize;
  info.subpixel_bits = basic.limits.subPixelPrecisionBits;
  for (uint8_t byte : v11.deviceUUID) info.uuid += fmt::format("{:02x}", byte);
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(physical, &memory);
  for (uint32_t heap = 0; heap < memory.memoryHeapCount; ++heap)
    if (memory.memoryHeaps[heap].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
      info.memory_bytes = std::max<uint64_t>(info.memory_bytes, memory.memoryHeaps[heap].size);
  return info;
}

// What to do about a device that lacks something.
std::string remedy(const DeviceInfo& info) {
  if (info.device_class == "lavapipe")
    return "this lavapipe is too old; install mesa-vulkan-drivers from bookworm-backports (Mesa 23 or newer)";
  return "install a newer driver or choose another device with --device";
}

// Light lists are walked by their union over a subgroup.
bool has_subgroup_arithmetic(VkPhysicalDevice physical) {
  VkPhysicalDeviceVulkan11Properties v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &v11};
  vkGetPhysicalDeviceProperties2(physical, &properties);
  constexpr VkShaderStageFlags stages = VK_SHADER_STAGE_FRAGMENT_BIT | VK_SHADER_STAGE_COMPUTE_BIT;
  return (v11.subgroupSupportedStages & stages) == stages &&
         (v11.subgroupSupportedOperations & VK_SUBGROUP_FEATURE_ARITHMETIC_BIT) != 0;
}

std::string why_unusable(VkPhysicalDevice physical, const DeviceInfo& info) {
  if (info.api_major < 1 || (info.api_major == 1 && info.api_minor < 3))
    return fmt::format("Vulkan {}.{} where 1.3 is needed: {}", info.api_major, info.api_minor, remedy(info));
  DeviceFeatures present;
  vkGetPhysicalDeviceFeatures2(physical, &present.core);
  std::string missing = missing_features(present);
  if (!has_subgroup_arithmetic(physical))
    missing += (missing.empty() ? "" : ", ") + std::string("subgroup arithmetic in fragment and compute shaders");
  return missing.empty() ? "" : fmt::format("lacks {}: {}", missing, remedy(info));
}

bool find_queues(Candidate& candidate) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(candidate.physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(candidate.physical, &count, families.data());
  return choose_queues(families, candidate);
}

// What a function of Vulkan lists. It is asked anew while the list grows between its length and itself.
template <class T, class List>
std::expected<std::vector<T>, VkResult> listed(List list) {
  while (true) {
    uint32_t count = 0;
    if (const VkResult result = list(&count, static_cast<T*>(nullptr)); result != VK_SUCCESS)
      return std::unexpected(result);
    std::vector<T> all(count);
    const VkResult result = list(&count, all.data());
    if (result == VK_INCOMPLETE) continue;
    if (result != VK_SUCCESS) return std::unexpected(result);
    all.resize(count);
    return all;
  }
}

std::unexpected<Error> failed_start(VkResult result, const char* call) {
  return std::unexpected(start_error(result, fmt::format("Vulkan does not start ({}: {})", call, result_name(result))));
}

Expected<bool> has_validation_layer() {
  const auto layers = listed<VkLayerProperties>(vkEnumerateInstanceLayerProperties);
  if (!layers) return failed_start(layers.error(), "vkEnumerateInstanceLayerProperties");
  return std::ranges::any_of(
      *layers, [](const VkLayerProperties& layer) { return std::strcmp(layer.layerName, validation_layer) == 0; });
}

// Extensions of the device that are of no version of Vulkan.
Expected<void> find_extensions(VkPhysicalDevice physical, DeviceInfo& info) {
  const auto extensions = listed<VkExtensionProperties>([&](uint32_t* count, VkExtensionProperties* all) {
    return vkEnumerateDeviceExtensionProperties(physical, nullptr, count, all);
  });
  if (!extensions) return failed_start(extensions.error(), "vkEnumerateDeviceExtensionProperties");
  const auto has = [&](std::string_view name) {
    return std::ranges::any_of(*extensions, [&](const VkExtensionProperties& e) { return name == e.extensionName; });
  };
  info.post_depth_coverage = has(VK_EXT_POST_DEPTH_COVERAGE_EXTENSION_NAME);
  VkPhysicalDeviceAccelerationStructureFeaturesKHR structures{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR};
  VkPhysicalDeviceRayQueryFeaturesKHR queries{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR};
  VkPhysicalDeviceRayTracingPipelineFeaturesKHR pipelines{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR};
  const auto look_up = [&](auto& feature, bool present) {
    VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &feature};
    if (present) vkGetPhysicalDeviceFeatures2(physical, &core);
  };
  look_up(structures,
          has(VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME) && has(VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME));
  look_up(queries, has(VK_KHR_RAY_QUERY_EXTENSION_NAME));
  look_up(pipelines, has(VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME));
  info.rays = {structures.accelerationStructure && queries.rayQuery,
               structures.accelerationStructure && pipelines.rayTracingPipeline};
  return {};
}

}  // namespace

DeviceFeatures::DeviceFeatures() {
  core.pNext = &v11;
  v11.pNext = &v12;
  v12.pNext = &v13;
}

std::string missing_features(const DeviceFeatures& present) {
  std::string missing;
  list_missing(present.core.features, required_core, missing);
  list_missing(present.v11, required_11, missing);
  list_missing(present.v12, required_12, missing);
  list_missing(present.v13, required_13, missing);
  return missing;
}

void enable_features(const DeviceFeatures& present, DeviceFeatures& wanted) {
  enable(wanted.core.features, required_core);
  enable(wanted.core.features, optional_core, &present.core.features);
  enable(wanted.v11, required_11);
  enable(wanted.v12, required_12);
  enable(wanted.v12, optional_12, &present.v12);
  enable(wanted.v13, required_13);
}

bool has_int64_atomics(VkPhysicalDevice physical) {
  DeviceFeatures present;
  vkGetPhysicalDeviceFeatures2(physical, &present.core);
  return present.v12.shaderBufferInt64Atomics;
}

bool has_float64(VkPhysicalDevice physical) {
  VkPhysicalDeviceFeatures present;
  vkGetPhysicalDeviceFeatures(physical, &present);
  return present.shaderFloat64;
}

bool has_primitive_ids(VkPhysicalDevice physical) {
  VkPhysicalDeviceFeatures present;
  vkGetPhysicalDeviceFeatures(physical, &present);
  return present.geometryShader;
}

Error start_error(VkResult result, std::string message) {
  const bool no_memory = result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY;
  const std::string missing = no_memory ? "memory" : what_runs_out();
  if (missing.empty()) return {ErrorKind::device, std::move(message), ""};
  return {ErrorKind::out_of_memory,
          fmt::format("{} ran out while Vulkan started ({}); raise the limit (ulimit, the container's) or end other "
                      "programs",
                      missing, message),
          ""};
}

Expected<std::vector<Candidate>> find_candidates(VkInstance instance) {
  const auto physical = listed<VkPhysicalDevice>(
      [&](uint32_t* count, VkPhysicalDevice* all) { return vkEnumeratePhysicalDevices(instance, count, all); });
  if (!physical) return failed_start(physical.error(), "vkEnumeratePhysicalDevices");
  if (physical->empty())
    if (Error error = start_error(VK_SUCCESS, "no device"); error.kind == ErrorKind::out_of_memory)
      return std::unexpected(std::move(error));
  std::vector<Candidate> candidates;
  for (size_t i = 0; i < physical->size(); ++i) {
    Candidate candidate;
    candidate.physical = (*physical)[i];
    candidate.info = describe_physical(candidate.physical, int(i));
    candidate.info.unusable = why_unusable(candidate.physical, candidate.info);
    if (auto found = find_extensions(candidate.physical, candidate.info); !found) return std::unexpected(found.error());
    if (candidate.info.unusable.empty()) candidate.info.int64_atomics = has_int64_atomics(candidate.physical);
    if (!find_queues(candidate) && candidate.info.unusable.empty())
      candidate.info.unusable = "has no queue for graphics and compute; choose another device with --device";
    candidate.info.paged_bytes = paged_bytes(candidate.physical, candidate.info, candidate.queue_family);
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(candidate.physical, &properties);
    candidate.timestamp_period_ns = properties.limits.timestampPeriod;
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

bool choose_queues(std::span<const VkQueueFamilyProperties> families, Candidate& candidate) {
  constexpr VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  const auto main = std::find_if(families.begin(), families.end(), [](const VkQueueFamilyProperties& family) {
    return (family.queueFlags & needed) == needed;
  });
  if (main == families.end()) return false;
  candidate.queue_family = uint32_t(main - families.begin());
  candidate.timestamp_bits = main->timestampValidBits;
  const auto alone = std::find_if(families.begin(), families.end(), [](const VkQueueFamilyProperties& family) {
    return (family.queueFlags & needed) == VK_QUEUE_COMPUTE_BIT && family.queueCount > 0;
  });
  const auto second = alone != families.end() ? alone : main;
  candidate.second_queue = second != main || main->queueCount > 1;
  candidate.compute_family = uint32_t(second - families.begin());
  candidate.compute_index = second == main && candidate.second_queue ? 1 : 0;
  candidate.compute_timestamp_bits = second->timestampValidBits;
  return true;
}

Expected<int> choose_device(std::span<const DeviceInfo> devices, std::string_view which) {
  int best = -1, unusable = -1;
  for (int i = 0; i < int(devices.size()); ++i) {
    if (!matches(devices[i], which)) continue;
    if (!devices[i].unusable.empty()) {
      if (unusable < 0) unusable = i;
    } else if (best < 0 || rank(devices[i]) < rank(devices[best])) {
      best = i;
    }
  }
  if (best >= 0) return best;
  if (unusable >= 0)
    return fail(ErrorKind::device, "", "the device {} cannot be used: it {}", devices[unusable].name,
                devices[unusable].unusable);
  if (which.empty()) return fail(ErrorKind::device, "", "{}", describe(devices));
  return fail(ErrorKind::device, "", "no device matches --device {}; {}", which, describe(devices));
}

Expected<VkInstance> create_instance(bool validate, const void* next) {
  if (Error error = start_error(VK_SUCCESS, "before the driver was opened"); error.kind == ErrorKind::out_of_memory)
    return std::unexpected(std::move(error));
  if (validate) {
    const auto layer = has_validation_layer();
    if (!layer) return std::unexpected(layer.error());
    if (!*layer)
      return fail(ErrorKind::device, "", "{} is not installed; install vulkan-validationlayers", validation_layer);
  }
  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "candela";
  application.pEngineName = "candela";
  application.apiVersion = VK_API_VERSION_1_3;
  const char* extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, next};
  info.pApplicationInfo = &application;
  if (validate) {
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &validation_layer;
    info.enabledExtensionCount = uint32_t(std::size(extensions));
    info.ppEnabledExtensionNames = extensions;
  }
  VkInstance instance = VK_NULL_HANDLE;
  const VkResult result = vkCreateInstance(&info, nullptr, &instance);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) return std::unexpected(start_error(result, no_driver()));
  if (result != VK_SUCCESS) return failed_start(result, "vkCreateInstance");
  return instance;
}

}  // namespace candela::gpu
