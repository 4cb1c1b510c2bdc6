#pragma once
#include <vector>

#include "gpu/device.h"

namespace candela::gpu {

// Samples a pixel, of 1, 2, 4 and 8, that the device has for attachments of both formats that shaders read. Vulkan
// promises 1 and 4. Drawn with another count, a device may leave samples out.
std::vector<int> sample_counts(const Device& device, VkFormat color, VkFormat depth);

// Whether compute may store into images of `samples` a pixel that are drawn into and sampled too.
bool stores_samples(const Device& device, VkFormat color, uint32_t samples);

}  // namespace candela::gpu
