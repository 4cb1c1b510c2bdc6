#pragma once
#include <optional>
#include <span>
#include <vector>

#include "base/pixel_rect.h"
#include "gpu/device.h"
#include "graph/plan.h"

// Memory by pages (sparse residency): where a region of a picture is rendered, images and buffers of the picture's
// pixels keep its size and coordinates, and only the pages about the region have memory. What is read elsewhere is 0,
// and what is written there is lost.
namespace candela::gpu {

// Bytes of images and buffers that may lie on pages at a time; 0: the device cannot, or does not promise those zeros.
uint64_t paged_bytes(VkPhysicalDevice physical, const DeviceInfo& info, uint32_t queue_family);

inline constexpr VkImageCreateFlags paged_image_flags =
    VK_IMAGE_CREATE_SPARSE_BINDING_BIT | VK_IMAGE_CREATE_SPARSE_RESIDENCY_BIT | VK_IMAGE_CREATE_SPARSE_ALIASED_BIT;
inline constexpr VkBufferCreateFlags paged_buffer_flags =
    VK_BUFFER_CREATE_SPARSE_BINDING_BIT | VK_BUFFER_CREATE_SPARSE_RESIDENCY_BIT | VK_BUFFER_CREATE_SPARSE_ALIASED_BIT;
// Whether an image of that description can be made with these flags, and works: lavapipe (Mesa 25.0) draws into such
// images elsewhere than it reads them.
bool can_be_paged(const Device& device, const VkImageCreateInfo& info);

// The pages of one image or buffer, in one piece of memory from its begin on.
struct Pages {
  VkMemoryRequirements needs{};  // of that memory
  std::vector<VkSparseImageMemoryBind> image_binds;
  std::vector<VkSparseMemoryBind> buffer_binds;
};
// Nothing: the device needs memory for what is of the whole image.
std::optional<Pages> pages_of(Device& device, VkImage image, VkImageAspectFlags aspect, const PixelRect& part);
// Of bytes `first` to `end`.
Pages pages_of(Device& device, VkBuffer buffer, uint64_t first, uint64_t end);

struct PageBinding {
  VkImage image = VK_NULL_HANDLE;  // one of both
  VkBuffer buffer = VK_NULL_HANDLE;
  Pages* pages = nullptr;
  VkDeviceMemory memory = VK_NULL_HANDLE;
};
// Returns when they are bound.
void bind_pages(Device& device, std::span<const PageBinding> bindings);

}  // namespace candela::gpu
