#include "gpu/pages.h"

#include <algorithm>

namespace candela::gpu {

uint64_t paged_bytes(VkPhysicalDevice physical, const DeviceInfo& info, uint32_t queue_family) {
  VkPhysicalDeviceFeatures features;
  vkGetPhysicalDeviceFeatures(physical, &features);
  if (!features.sparseBinding || !features.sparseResidencyBuffer || !features.sparseResidencyImage2D ||
      !features.sparseResidencyAliased)
    return 0;
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  if (queue_family >= count || !(families[queue_family].queueFlags & VK_QUEUE_SPARSE_BINDING_BIT)) return 0;
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(physical, &properties);
  // lavapipe maps pages of zeros there, but does not say so, for what is written to them stays.
  if (!properties.sparseProperties.residencyNonResidentStrict && info.device_class != "lavapipe") return 0;
  return properties.limits.sparseAddressSpaceSize;
}

bool can_be_paged(const Device& device, const VkImageCreateInfo& info) {
  const VkPhysicalDevice physical = device.physical();
  constexpr VkImageUsageFlags drawn = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  if (device.info().device_class == "lavapipe" && (info.usage & drawn)) return false;
  VkImageFormatProperties format;
  if (vkGetPhysicalDeviceImageFormatProperties(physical, info.format, info.imageType, info.tiling, info.usage,
                                               info.flags | paged_image_flags, &format) != VK_SUCCESS ||
      !(format.sampleCounts & info.samples) || format.maxExtent.width < info.extent.width ||
      format.maxExtent.height < info.extent.height)
    return false;
  uint32_t count = 0;
  vkGetPhysicalDeviceSparseImageFormatProperties(physical, info.format, info.imageType, info.samples, info.usage,
                                                 info.tiling, &count, nullptr);
  return count == 1;
}

std::optional<Pages> pages_of(Device& device, VkImage image, VkImageAspectFlags aspect, const PixelRect& part) {
  Pages pages;
  vkGetImageMemoryRequirements(device.handle(), image, &pages.needs);
  uint32_t count = 0;
  vkGetImageSparseMemoryRequirements(device.handle(), image, &count, nullptr);
  std::vector<VkSparseImageMemoryRequirements> all(count);
  vkGetImageSparseMemoryRequirements(device.handle(), image, &count, all.data());
  // Not compared with `aspect`: lavapipe calls depth a colour.
  if (count != 1 || (all[0].formatProperties.aspectMask & VK_IMAGE_ASPECT_METADATA_BIT) ||
      all[0].imageMipTailFirstLod == 0)
    return {};
  const VkExtent3D page = all[0].formatProperties.imageGranularity;
  const int width = int(page.width), height = int(page.height);
  const uint64_t bytes = pages.needs.alignment;
  const auto whole = [](int px, int side) { return (px + side - 1) / side * side; };
  const int x = part.x / width * width, end_x = whole(part.end_x(), width);
  uint64_t offset = 0;
  for (int y = part.y / height * height; y < part.end_y(); y += height)
    for (int left = x; left < end_x; left += width, offset += bytes) {
      VkSparseImageMemoryBind bind{};
      bind.subresource = {aspect, 0, 0};
      bind.offset = {left, y, 0};
      bind.extent = page;
      bind.memoryOffset = offset;
      pages.image_binds.push_back(bind);
    }
  pages.needs.size = offset;
  return pages;
}

Pages pages_of(Device& device, VkBuffer buffer, uint64_t first, uint64_t end) {
  Pages pages;
  vkGetBufferMemoryRequirements(device.handle(), buffer, &pages.needs);
  const uint64_t page = pages.needs.alignment;
  VkSparseMemoryBind bind{};
  bind.resourceOffset = first / page * page;
  bind.size = std::min((end + page - 1) / page * page, pages.needs.size) - bind.resourceOffset;
  pages.needs.size = bind.size;
  pages.buffer_binds.push_back(bind);
  return pages;
}

void bind_pages(Device& device, std::span<const PageBinding> bindings) {
  if (bindings.empty()) return;
  std::vector<VkSparseImageMemoryBindInfo> images;
  std::vector<VkSparseBufferMemoryBindInfo> buffers;
  for (const PageBinding& b : bindings) {
    for (VkSparseImageMemoryBind& bind : b.pages->image_binds) bind.memory = b.memory;
    for (VkSparseMemoryBind& bind : b.pages->buffer_binds) bind.memory = b.memory;
    if (b.image)
      images.push_back({b.image, uint32_t(b.pages->image_binds.size()), b.pages->image_binds.data()});
    else
      buffers.push_back({b.buffer, uint32_t(b.pages->buffer_binds.size()), b.pages->buffer_binds.data()});
  }
  VkBindSparseInfo info{VK_STRUCTURE_TYPE_BIND_SPARSE_INFO};
  info.bufferBindCount = uint32_t(buffers.size()), info.pBufferBinds = buffers.data();
  info.imageBindCount = uint32_t(images.size()), info.pImageBinds = images.data();
  const VkFenceCreateInfo made{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  VkFence fence = VK_NULL_HANDLE;
  VK_CHECK(vkCreateFence(device.handle(), &made, nullptr, &fence));
  VkResult result = vkQueueBindSparse(device.queue(), 1, &info, fence);
  if (result == VK_SUCCESS) result = vkWaitForFences(device.handle(), 1, &fence, VK_TRUE, UINT64_MAX);
  vkDestroyFence(device.handle(), fence, nullptr);
  vk_check(result, "vkQueueBindSparse");
}

}  // namespace candela::gpu
