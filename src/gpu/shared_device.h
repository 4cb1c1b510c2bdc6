#pragma once
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "gpu/device_select.h"
#include "gpu/pipeline_store.h"

// What a process opens once and its Devices share: drivers give only so many instances and devices in a process's life,
// and each costs a tenth of a second. Kept until the process ends.
namespace candela::gpu {

// Messages of the validation layer, each once.
class MessageLog {
 public:
  void add(const std::string& message);
  std::vector<std::string> messages() const;

 private:
  mutable std::mutex mutex_;  // guards what follows
  std::vector<std::string> messages_;
  std::set<std::string> seen_;
};

struct OpenInstance {
  VkInstance handle = VK_NULL_HANDLE;
  std::vector<Candidate> candidates;  // its devices
  // With the validation layer, else null.
  PFN_vkSetDebugUtilsObjectNameEXT set_name = nullptr;
  PFN_vkCmdBeginDebugUtilsLabelEXT begin_label = nullptr;
  PFN_vkCmdEndDebugUtilsLabelEXT end_label = nullptr;
  // Logs that get the messages from now on.
  void attach(MessageLog* log);
  void detach(MessageLog* log);
  void pass_on(const std::string& message);

  OpenInstance() = default;
  ~OpenInstance();
  OpenInstance(const OpenInstance&) = delete;
  OpenInstance& operator=(const OpenInstance&) = delete;
  Expected<void> open(bool validate);

 private:
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  PFN_vkDestroyDebugUtilsMessengerEXT destroy_messenger_ = nullptr;
  std::mutex mutex_;
  std::set<MessageLog*> logs_;
};

struct OpenDevice {
  std::shared_ptr<OpenInstance> instance;
  Candidate chosen;
  VkDevice handle = VK_NULL_HANDLE;
  std::unique_ptr<PipelineStore> store;

  OpenDevice() = default;
  ~OpenDevice();
  OpenDevice(const OpenDevice&) = delete;
  OpenDevice& operator=(const OpenDevice&) = delete;
};

// Of the instance without the validation layer; none of another.
std::optional<Candidate> candidate_without_validation(VkInstance instance, VkPhysicalDevice device);
// Opens it, with both queues where it has two.
Expected<VkDevice> create_device(const Candidate& chosen);
// The process's instance, with the validation layer or without. Errors as find_candidates(); the next call tries again.
Expected<std::shared_ptr<OpenInstance>> shared_instance(bool validate);
// The device that `which` means (DeviceOptions::which): the one that is open, unless it is lost.
Expected<std::shared_ptr<OpenDevice>> shared_device(bool validate, std::string_view which);

}  // namespace candela::gpu
