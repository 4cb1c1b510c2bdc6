#pragma once
#include <memory_resource>
#include <vector>

#include "gpu/physical.h"

namespace candela::gpu {

// Copies between the subresources of an image and tightly packed bytes: mip by mip, and within a mip layer by layer.
std::pmr::vector<VkBufferImageCopy> copy_regions(const ImageDesc& desc, const PhysicalImage& image,
                                                 const ImageRange& range, std::pmr::memory_resource* memory);
uint64_t range_bytes(const ImageDesc& desc, const ImageRange& range);
VkExtent3D mip_extent(const ImageDesc& desc, uint32_t mip);

}  // namespace candela::gpu
