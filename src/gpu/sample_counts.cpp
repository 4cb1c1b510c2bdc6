#include "gpu/sample_counts.h"

namespace candela::gpu {
namespace {

VkSampleCountFlags counts_of(const Device& device, VkFormat format, VkImageUsageFlags usage) {
  VkImageFormatProperties properties{};
  const VkResult result =
      vkGetPhysicalDeviceImageFormatProperties(device.physical(), format, VK_IMAGE_TYPE_2D, VK_IMAGE_TILING_OPTIMAL,
                                               usage | VK_IMAGE_USAGE_SAMPLED_BIT, 0, &properties);
  if (result == VK_ERROR_FORMAT_NOT_SUPPORTED) return VK_SAMPLE_COUNT_1_BIT;
  vk_check(result, "vkGetPhysicalDeviceImageFormatProperties");
  return properties.sampleCounts;
}

}  // namespace

std::vector<int> sample_counts(const Device& device, VkFormat color, VkFormat depth) {
  const VkSampleCountFlags both = counts_of(device, color, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT) &
                                  counts_of(device, depth, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
  std::vector<int> possible;
  for (const int n : {1, 2, 4, 8})
    if (n == 1 || (both & VkSampleCountFlags(n))) possible.push_back(n);
  return possible;
}

bool stores_samples(const Device& device, VkFormat color, uint32_t samples) {
  VkPhysicalDeviceFeatures features;
  vkGetPhysicalDeviceFeatures(device.physical(), &features);
  return features.shaderStorageImageMultisample &&
         (counts_of(device, color, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_STORAGE_BIT) & samples) != 0;
}

}  // namespace candela::gpu
