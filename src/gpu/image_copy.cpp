#include "gpu/image_copy.h"

#include "graph/formats.h"

namespace candela::gpu {

VkExtent3D mip_extent(const ImageDesc& desc, uint32_t mip) {
  return {mip_size(desc.width_px, mip), mip_size(desc.height_px, mip), mip_size(desc.depth_px, mip)};
}

namespace {
uint64_t mip_bytes(const ImageDesc& desc, uint32_t mip, uint32_t layers) {
  const VkExtent3D extent = mip_extent(desc, mip);
  return uint64_t(extent.width) * extent.height * extent.depth * layers * copied_bytes(desc.format);
}
}  // namespace

std::pmr::vector<VkBufferImageCopy> copy_regions(const ImageDesc& desc, const PhysicalImage& image,
                                                 const ImageRange& range, std::pmr::memory_resource* memory) {
  std::pmr::vector<VkBufferImageCopy> regions(memory);
  uint64_t offset = 0;
  for (uint32_t mip = range.first_mip; mip < range.first_mip + range.mip_count; ++mip) {
    VkBufferImageCopy region{};
    region.bufferOffset = offset;
    region.imageSubresource = {image.texels, mip, range.first_layer, range.layer_count};
    region.imageExtent = mip_extent(desc, mip);
    regions.push_back(region);
    offset += mip_bytes(desc, mip, range.layer_count);
  }
  return regions;
}

uint64_t range_bytes(const ImageDesc& desc, const ImageRange& range) {
  uint64_t bytes = 0;
  for (uint32_t mip = range.first_mip; mip < range.first_mip + range.mip_count; ++mip)
    bytes += mip_bytes(desc, mip, range.layer_count);
  return bytes;
}

}  // namespace candela::gpu
