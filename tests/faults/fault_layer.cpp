// A Vulkan layer for tests alone: one call of a function that may fail gives an error instead of being made.
//   FAULT_AT=N      the N-th such call of the process, from 1; FAULT_RESULT=R the VkResult it gives, and that of every
//                   call after it where R is VK_ERROR_DEVICE_LOST: a lost device stays lost
//   FAULT_LIST=FILE the names of all calls, a line each, in the order made
//   FAULT_NAME=NAME counts, fails and lists only calls of that function
//   FAULT_FROM=NAME counts, fails and lists only from the first call of that function on, and only calls of the thread
//                   that made it: where threads work side by side, the N-th call of the process differs between runs
// One instance and one device at a time.
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string_view>
#include <thread>

namespace {

std::mutex mutex;
long calls = 0;
bool lost = false;

long number(const char* name) {
  const char* text = std::getenv(name);
  return text ? std::atol(text) : 0;
}

bool may_be_lost(const char* name) {
  for (const char* one : {"vkQueueSubmit2", "vkWaitForFences", "vkDeviceWaitIdle", "vkGetQueryPoolResults"})
    if (std::strcmp(name, one) == 0) return true;
  return false;
}

// VK_SUCCESS: the call is to be made.
VkResult fault(const char* name) {
  static const long at = number("FAULT_AT");
  static const VkResult result = VkResult(number("FAULT_RESULT"));
  static const char* const file = std::getenv("FAULT_LIST");
  static const char* const only = std::getenv("FAULT_NAME");
  static const char* const from = std::getenv("FAULT_FROM");
  static std::thread::id counted;  // the thread that called FAULT_FROM first
  const std::lock_guard hold(mutex);
  if (from && counted == std::thread::id() && std::strcmp(name, from) == 0) counted = std::this_thread::get_id();
  const VkResult unchanged = lost && may_be_lost(name) ? VK_ERROR_DEVICE_LOST : VK_SUCCESS;
  if (from && counted != std::this_thread::get_id()) return unchanged;
  if (only && std::strcmp(name, only) != 0) return unchanged;
  ++calls;
  if (file)
    if (std::FILE* list = std::fopen(file, calls == 1 ? "w" : "a")) {
      std::fprintf(list, "%s\n", name);
      std::fclose(list);
    }
  if (unchanged != VK_SUCCESS || at != calls) return unchanged;
  lost = result == VK_ERROR_DEVICE_LOST;
  std::fprintf(stderr, "fault: %s gives %d\n", name, int(result));
  return result;
}

bool waits(std::string_view name) { return name == "vkWaitForFences" || name == "vkDeviceWaitIdle"; }

PFN_vkGetInstanceProcAddr next_instance_function = nullptr;
PFN_vkGetDeviceProcAddr next_device_function = nullptr;
VkInstance instance = VK_NULL_HANDLE;

// A function between the program and the driver, by name.
template <size_t N>
struct Name {
  constexpr Name(const char (&text)[N]) {
    for (size_t i = 0; i < N; ++i) characters[i] = text[i];
  }
  char characters[N];
};
template <Name name, class Function>
struct Hook;
template <Name name, class... A>
struct Hook<name, VkResult (*)(A...)> {
  static inline VkResult (*next)(A...) = nullptr;
  static VkResult call(A... arguments) {
    const VkResult failed = fault(name.characters);
    if (failed == VK_SUCCESS) return next(arguments...);
    // A lost device has nothing in flight any more (Vulkan 1.3, "Lost Device"); the one below goes on, so its work is
    // waited for where the program does.
    if (failed == VK_ERROR_DEVICE_LOST && waits(name.characters)) next(arguments...);
    return failed;
  }
};

using Void = PFN_vkVoidFunction;

template <Name name, class Function>
Void hooked(const char* asked, Void next) {
  if (std::strcmp(asked, name.characters) != 0 || !next) return nullptr;
  Hook<name, Function>::next = reinterpret_cast<Function>(next);
  return reinterpret_cast<Void>(&Hook<name, Function>::call);
}

// clang-format off
#define FUNCTIONS(X) \
  X(vkAllocateMemory) X(vkMapMemory) X(vkInvalidateMappedMemoryRanges) X(vkBindBufferMemory) \
  X(vkBindImageMemory) X(vkCreateBuffer) X(vkCreateImage) X(vkCreateImageView) X(vkCreateSampler) \
  X(vkCreateFence) X(vkCreateSemaphore) X(vkCreateQueryPool) X(vkCreateCommandPool) \
  X(vkAllocateCommandBuffers) X(vkBeginCommandBuffer) X(vkEndCommandBuffer) X(vkResetCommandPool) \
  X(vkResetFences) X(vkCreateDescriptorPool) X(vkCreateDescriptorSetLayout) X(vkAllocateDescriptorSets) \
  X(vkCreatePipelineLayout) X(vkCreatePipelineCache) X(vkGetPipelineCacheData) X(vkCreateShaderModule) \
  X(vkCreateGraphicsPipelines) X(vkCreateComputePipelines) X(vkQueueSubmit2) X(vkWaitForFences) \
  X(vkDeviceWaitIdle) X(vkGetQueryPoolResults) X(vkEnumeratePhysicalDevices) \
  X(vkEnumerateDeviceExtensionProperties) X(vkGetPhysicalDeviceImageFormatProperties)
// clang-format on

// The function of the layer for that name; null where it passes the call on.
Void of_layer(const char* name, Void next) {
#define TRY(f) \
  if (Void found = hooked<#f, PFN_##f>(name, next)) return found;
  FUNCTIONS(TRY)
#undef TRY
  return nullptr;
}

template <class Link>
Link* link_of(const void* chain, VkStructureType type) {
  for (auto* at = const_cast<Link*>(static_cast<const Link*>(chain)); at;
       at = const_cast<Link*>(static_cast<const Link*>(at->pNext)))
    if (at->sType == type && at->function == VK_LAYER_LINK_INFO) return at;
  return nullptr;
}

VkResult create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator, VkInstance* made) {
  auto* link = link_of<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  next_instance_function = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  if (const VkResult failed = fault("vkCreateInstance"); failed != VK_SUCCESS) return failed;
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(next_instance_function(nullptr, "vkCreateInstance"));
  const VkResult result = create(info, allocator, made);
  instance = *made;
  return result;
}

VkResult create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                       const VkAllocationCallbacks* allocator, VkDevice* made) {
  auto* link = link_of<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  next_device_function = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  const auto create =
      reinterpret_cast<PFN_vkCreateDevice>(link->u.pLayerInfo->pfnNextGetInstanceProcAddr(instance, "vkCreateDevice"));
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  if (const VkResult failed = fault("vkCreateDevice"); failed != VK_SUCCESS) return failed;
  return create(physical, info, allocator, made);
}

Void device_function(VkDevice device, const char* name);

Void instance_function(VkInstance of, const char* name) {
  if (std::strcmp(name, "vkGetInstanceProcAddr") == 0) return reinterpret_cast<Void>(&instance_function);
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return reinterpret_cast<Void>(&device_function);
  if (std::strcmp(name, "vkCreateInstance") == 0) return reinterpret_cast<Void>(&create_instance);
  if (std::strcmp(name, "vkCreateDevice") == 0) return reinterpret_cast<Void>(&create_device);
  if (!next_instance_function) return nullptr;
  const Void next = next_instance_function(of, name);
  const Void found = of_layer(name, next);
  return found ? found : next;
}

Void device_function(VkDevice device, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0) return reinterpret_cast<Void>(&device_function);
  const Void next = next_device_function(device, name);
  const Void found = of_layer(name, next);
  return found ? found : next;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) VkResult vkNegotiateLoaderLayerInterfaceVersion(
    VkNegotiateLayerInterface* versions) {
  versions->loaderLayerInterfaceVersion = 2;
  versions->pfnGetInstanceProcAddr = &instance_function;
  versions->pfnGetDeviceProcAddr = &device_function;
  versions->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
