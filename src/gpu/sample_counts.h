#pragma once
#include <vector>

#include "gpu/device.h"

namespace candela::gpu {

// Samples a pixel, of 1, 2, 4 and 8, that the device has for attachments of both formats that shaders read. Vulkan
// promises 1 and 4. Drawn with another count, a device may leave samples out.
std::vector<int> sample_counts(const Device& device, VkFormat color, VkFormat depth);

}  // namespace candela::gpu
